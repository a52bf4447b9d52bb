"""Whole flights over DDS: the same every time, at the pace asked for, readable by others."""

from collections import defaultdict
import json
from pathlib import Path

from lta_analysis.bag.reader import read_bag
from lta_analysis.loop import Loop, Policy
from lta_config.topics import topic_table
from lta_control.gains_file import load_gains
from lta_control.strategies import strategy
from lta_sim.readings import Outcome
from lta_sim.scenario import load_scenario
from lta_sim.vehicle import load_vehicle
from lta_sim.world import World
import pytest
from rosbags.highlevel import AnyReader

TABLE = topic_table()
REPEATABLE = [f'/lta1/{name}' for name, topic in TABLE.topics.items() if topic.repeatable]


def contents(bag: Path) -> dict[str, list[tuple[int, bytes]]]:
    """Return log times and bytes by topic, as the genuine rosbags library reads them."""
    found = defaultdict(list)
    with AnyReader([bag]) as reader:
        for connection, log_time, data in reader.messages():
            found[connection.topic].append((log_time, bytes(data)))
    return found


@pytest.fixture
def fly(lta, scenario, tmp_path):
    """Return a function that flies and returns the printed results."""

    def run(name: str, *options: str, **goal: str) -> dict[str, object]:
        path = scenario(**goal)
        out = tmp_path / name
        result = lta.run('fly', '--no-page', '--json', '--scenario', path, '--out', out, *options)
        assert 'Traceback' not in result.stderr
        return {**json.loads(result.stdout), 'status': result.returncode, 'said': result.stderr}

    return run


def test_one_seed_is_one_flight_and_another_is_another(fly):
    """Byte for byte in every repeatable topic; and the loop in one process flies the same path."""
    goal = {'time_limit': '8 s'}
    first, again = (fly(name, '--seed', '7', **goal) for name in ('first', 'again'))
    assert (first['outcome'], first['status']) == ('timeout', 1), first['said']
    one, two = contents(Path(first['bag'])), contents(Path(again['bag']))
    for topic in REPEATABLE:
        assert one[topic] == two[topic], topic  # log times as well
        assert one[topic], topic

    third = fly('other', '--seed', '8', **goal)
    assert third['outcome'] == 'timeout', third['said']
    other = contents(Path(third['bag']))
    for topic in ('/lta1/imu', '/lta1/photodiodes', '/lta1/motors', '/lta1/odom'):
        assert [data for _, data in other[topic]] != [data for _, data in one[topic]], topic
    check_against_the_loop(Path(first['bag']), goal)


def check_against_the_loop(bag, goal):
    """
    Compare the true path with that of the same cores in one process.

    Between them lies the setpoint's heading, which a message carries as sine and cosine: a
    rounding error of 1e-16 to begin with, which the contact with the floor makes grow.
    """
    path = bag.parents[1] / f'1.0m-{goal["time_limit"]}.yaml'.replace(' ', '')
    scene = load_scenario(str(path))
    vehicle = load_vehicle('gtmab', scene.air.density)
    world = World(vehicle, scene, TABLE, 7)
    gains = load_gains('gtmab')
    loop = Loop(world, TABLE, Policy(strategy=strategy('bag'), gains=gains))
    truth = {}
    while world.outcome is Outcome.FLYING:
        truth[world.stamp_ns] = tuple(world.state[:3].tolist())
        loop.step()
    compared = 0
    with AnyReader([bag]) as reader:
        connections = [c for c in reader.connections if c.topic == '/lta1/ground_truth/odom']
        for connection, _, data in reader.messages(connections):
            message = reader.deserialize(data, connection.msgtype)
            stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
            p = message.pose.pose.position
            if stamp in truth:
                assert (p.x, p.y, p.z) == pytest.approx(truth[stamp], rel=0.0, abs=1e-7)
                compared += 1
    assert compared > 350


def test_a_flight_to_the_goal(fly, lta):
    """The bag is whole: every topic of the table has every message that its rhythm makes due."""
    flown = fly('near', radius='6.5 m')
    assert (flown['outcome'], flown['status']) == ('reached', 0)
    assert flown['pace'] > 1.0
    bag = read_bag(flown['bag'])
    assert bag.complete
    end = max(when for _, when, _ in bag.messages(['/lta1/imu']))
    for name, topic in TABLE.topics.items():
        full = name if name.startswith('/') else f'/lta1/{name}'
        assert bag.topics[full].type_name == topic.type
        if topic.period_ns:
            # What lags may be answered after the end: the last step is not awaited by all.
            due = TABLE.due(name, end)
            assert due - 1 <= bag.topics[full].count <= due, name
    for key in ('seed', 'commit', 'config_sha256', 'vehicle_file', 'scenario_file', 'strategy'):
        assert bag.provenance[key]
    table = lta.run('bag', 'info', flown['bag'])
    assert table.returncode == 0
    assert '/lta1/photodiodes' in table.stdout
    facts = json.loads(lta.run('bag', 'info', '--json', flown['bag']).stdout)
    assert facts['complete']
    assert facts['messages'] == sum(len(each) for each in contents(Path(flown['bag'])).values())


def test_real_time_is_real_time(fly):
    flown = fly('real', '--time', 'realtime', time_limit='5 s')
    assert flown['outcome'] == 'timeout'
    assert flown['pace'] == pytest.approx(1.0, abs=0.02)
