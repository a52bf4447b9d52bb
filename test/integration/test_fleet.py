# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A fleet in one launch: each as alone, both in one bag, and faults named with their robot."""

import json
import os
import signal
import time

from frame_tree import nanoseconds, resolve_all
from lta_bag.reader import read_bag
from lta_config.parameter_override import parse_assignment
from lta_config.topics import load_topic_table
from lta_data.bag.recorded_flight import open_flight
from lta_flight.flight_spec import load_spec
from lta_flight.progress import FlightProgress
from lta_flight.simulate import simulate_once
import pytest
from rich.console import Console

from .contents import check_one_clock, contents

TABLE = load_topic_table()
REPEATABLE = [name for name, topic in TABLE.topics.items() if topic.repeatable and name[0] != '/']
GOALS = {'radius': '6.5 m', 'time_limit': '30 s'}  # 0.5 m from the one start, 0.8 from the other
OFFSET = -2.0


def read_frames(path, topic, prefix):
    """Return log time, frames without the prefix, stamp and numbers of a robot's transforms."""
    bag, found = read_bag(path), []
    for _, when, data in bag.iterate_messages([topic]):
        for item in bag.decode(topic, data).transforms:
            if item.child_frame_id.startswith(prefix):
                frames = item.header.frame_id, item.child_frame_id
                bare = tuple(name.removeprefix(prefix) for name in frames)
                p, q = item.transform.translation, item.transform.rotation
                numbers = (nanoseconds(item.header.stamp), p.x, p.y, p.z, q.x, q.y, q.z, q.w)
                found.append((when, bare, numbers))
    return sorted(found)


def verdicts(text):
    """Return what the simulator said last of each flight, by robot."""
    lines = [line for line in text.splitlines() if line.startswith('[simulator] {')]
    states = [json.loads(line.partition('] ')[2]) for line in lines]
    return {state['robot']: state for state in states}


@pytest.fixture
def fleet(lta, scenario, tmp_path):
    """Return the bag of two drones in lockstep, and how each flight went."""
    words = ('seed:=7', f'spacing:={-OFFSET}', 'time:=lockstep')
    bag = tmp_path / 'fleet'
    result = lta.run('launch', 'fleet', f'scenario:={scenario(**GOALS)}', f'bag:={bag}', *words)
    assert result.returncode == 0, result.stderr
    assert 'Traceback' not in result.stderr
    assert f'\nBag  {bag}  (its messages: ' in result.stdout
    for robot in ('lta1', 'lta2'):
        page = tmp_path / f'report-{robot}.html'
        assert f'\nPage {page}  (' in result.stdout
        assert page.is_file()
    return bag, verdicts(result.stdout)


@pytest.mark.long
def test_each_flies_as_it_would_alone(call, scenario, tmp_path, fleet):
    """
    Byte for byte and log time by log time, though one flies on when the other is there.

    Alone they fly in one process: test_flight.py holds that to the graph of one.
    """
    bag, told = fleet
    assert {robot: item['outcome'] for robot, item in told.items()} == {
        'lta1': 'reached',
        'lta2': 'reached',
    }
    ends = sorted(float(item['time_s']) for item in told.values())
    assert ends[1] > ends[0] + 0.1
    for robot, seed, offset in (('lta1', 7, 0.0), ('lta2', 8, OFFSET)):
        alone = tmp_path / f'alone-{robot}'
        spec = load_spec('gtmab', str(scenario(**GOALS)), 'homing', 'gtmab')
        spec = spec.with_values(dict([parse_assignment(f'scenario.start.position.1={offset} m')]))
        flown, _ = simulate_once(spec, seed, alone, FlightProgress(Console(quiet=True)))
        assert flown.outcome == 'reached'
        both, single = contents(bag, prefix=f'{robot}/'), contents(flown.bag)
        for name in REPEATABLE:
            assert single[f'/lta1/{name}'], name
            assert both[f'/{robot}/{name}'] == single[f'/lta1/{name}'], (robot, name)
        for topic in ('/tf', '/tf_static'):
            named = read_frames(bag, topic, f'{robot}/')
            assert named == read_frames(flown.bag, topic, '') != [], (robot, topic)

    found = resolve_all(read_bag(bag))
    links = ('odom', 'base_link', 'imu_link', 'range_link', 'panel_link')
    assert found == {'map', *(f'{robot}/{link}' for robot in ('lta1', 'lta2') for link in links)}

    # One /clock, which never goes back and outlasts the first that is there.
    clock = open_flight(bag, 'lta1')['/clock']
    times = (clock['clock.sec'] + 1e-9 * clock['clock.nanosec']).to_numpy()
    assert (times[1:] >= times[:-1]).all()
    start = 1e-9 * TABLE.start_ns
    assert start + ends[0] < times[-1] <= start + ends[1]
    assert read_bag(bag).is_complete
    check_reading(call, bag)


def check_reading(call, bag):
    """Look at the bag of both by the command: with a robot's name, and without."""
    status, said = call('report', bag)
    assert (status, said.out) == (2, '')
    assert said.err == (
        f"'{bag}' contains several robots (lta1, lta2); choose one, as in --robot lta2.\n"
    )
    status, said = call('report', bag, '--robot', 'lta2')
    assert status == 0, said.err
    page = (bag.parent / 'report-lta2.html').read_text()
    assert 'seed 8' in page
    assert 'launch fly vehicle:=gtmab' in page
    assert f'offset_y:={OFFSET}' in page
    check_one_clock(call, bag, 'lta2')
    shown = call('bag', 'info', bag)[1].out
    assert 'messages of lta1 and lta2 in' in shown
    for line in ('/lta1/odom', '/lta2/odom', 'lta1/seed: 7', 'lta2/seed: 8'):
        assert line in shown
    facts = json.loads(call('bag', 'info', '--json', bag)[1].out)
    assert facts['robots'] == ['lta1', 'lta2']
    flight = open_flight(bag, 'lta2')
    assert flight.provenance['seed'] == '8'
    start = flight['ground_truth/odom'].iloc[0]
    assert [start[f'pose.pose.position.{axis}'] for axis in 'xy'] == [-3.5, OFFSET]


@pytest.mark.long
def test_who_holds_both_up_is_named_with_its_robot_and_nobody_else(
    lta, flying, scenario, tmp_path
):
    # As long as the test takes.
    path = scenario(radius='0.01 m', time_limit='600 s', walls='solid')
    words = (f'scenario:={path}', 'time:=lockstep', f'bag:={tmp_path / "bag"}')
    flight = lta.start('launch', 'fleet', *words)
    flying(8.0)  # DDS has found everyone
    refused = lta.run('launch', 'fly', f'bag:={tmp_path / "second"}')
    assert refused.returncode == 2
    assert refused.stderr.startswith('lta1 and lta2 are flying on ROS domain ')
    before = len(flight.lines)
    pid = flight.node('estimator', 'lta2')
    os.kill(pid, signal.SIGSTOP)
    flight.said('No messages arrive from lta2/estimator.')
    time.sleep(2.0)  # in which both graphs stand, and the nodes say for whom they wait
    named = [line for _, line in flight.lines[before:] if line.startswith('No messages arrive')]
    assert named == ['No messages arrive from lta2/estimator.']
    os.kill(pid, signal.SIGKILL)
    flight.said('lta2/estimator was killed by SIGKILL.')
    assert flight.end() == 1
    assert read_bag(tmp_path / 'bag').is_complete
