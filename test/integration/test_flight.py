# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whole flights, over DDS and in one process: the same every time, readable by others."""

import json
from pathlib import Path

from frame_tree import resolve_all
from lta_bag.reader import read_bag
from lta_config.files import find_file, load_yaml
from lta_config.topics import load_topic_table, robot_topic
from lta_data.bag.recorded_flight import open_flight
from lta_graph.quality import LOCKSTEP_HISTORY_NS
import pytest
import yaml

from .contents import check_one_clock, contents

OWN = Path(__file__).resolve().parents[2] / 'examples' / 'own_strategy.py'
TABLE = load_topic_table()
REPEATABLE = [
    robot_topic('lta1', name) for name, topic in TABLE.topics.items() if topic.repeatable
]


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


def test_a_flight_to_the_lamp_is_whole_and_that_of_one_process(lta, call, tmp_path):
    """
    From rest to the lamp: every repeatable topic has the same messages, bytes and log times.

    The flight is longer than what lockstep topics keep, so that the middleware's memory is reused.
    """
    results = {}
    near = tmp_path / 'near.yaml'  # a shorter flight, but long enough for that
    text = find_file('scenario', 'lamp_room').read_text(encoding='utf-8')
    near.write_text(text.replace('value: [-3.5, 0]', 'value: [-1.5, 0]'))
    # A strategy from a file, so that nodes and loop read it alike
    words = ('--seed', '7', '--scenario', near, '--strategy', OWN, '--json', '--out')
    done = lta.run('fly', *words, tmp_path / 'fly')
    assert done.returncode == 0, done.stderr
    results['fly'] = json.loads(done.stdout)
    status, said = call('simulate', *words, tmp_path / 'simulate')
    assert status == 0, said.err
    results['simulate'] = json.loads(said.out)
    graph, loop = (contents(Path(results[verb]['bag'])) for verb in ('fly', 'simulate'))
    stamps = [when for when, _ in graph['/lta1/imu']]
    assert max(stamps) - min(stamps) > LOCKSTEP_HISTORY_NS
    for each in (graph, loop):  # by the description and by the simulator, in either order
        each['/tf_static'].sort()
    for topic in REPEATABLE:
        assert len(graph[topic]) == len(loop[topic]) > 0, topic
        for index, (expected, found) in enumerate(zip(graph[topic], loop[topic], strict=True)):
            assert found == expected, (topic, index)
    assert set(loop) == set(REPEATABLE)
    own = {'pace', 'bag', 'page'}
    kept = [{k: v for k, v in told.items() if k not in own} for told in results.values()]
    assert kept[0] == kept[1]
    check_whole(results['fly']['bag'], call)
    check_one_clock(call, results['fly']['bag'])


def check_whole(path, call):
    """Hold a bag to every topic of the table, with every message that its rhythm makes due."""
    bag = read_bag(path)
    assert bag.is_complete
    end = max(when for _, when, _ in bag.iterate_messages(['/lta1/imu']))
    for name, topic in TABLE.topics.items():
        full = name if name.startswith('/') else f'/lta1/{name}'
        if not topic.recorded:
            assert full not in bag.topics
            continue
        assert bag.topics[full].type_name == topic.type
        if topic.period_ns:
            # What lags may be answered after the end: the last step is not awaited by all.
            due = TABLE.count_due(name, end)
            assert due - 1 <= bag.topics[full].count <= due, name
    assert resolve_all(bag) > {'map', 'odom', 'base_link', 'imu_link'}
    for key in ('seed', 'commit', 'config_sha256', 'vehicle_file', 'scenario_file', 'strategy'):
        assert bag.provenance[key]
    status, table = call('bag', 'info', path)
    assert status == 0
    assert '/lta1/photodiodes' in table.out
    facts = json.loads(call('bag', 'info', '--json', path)[1].out)
    assert facts['complete']
    assert facts['messages'] == sum(len(each) for each in contents(Path(path)).values())


@pytest.mark.long
def test_a_changed_parameter_is_kept_in_files_that_the_graph_flies(lta, tmp_path):
    """
    `--set` writes what it changed beside the bag; the graph flies that to the same bytes.

    It is a course with shaken motors, which navigator and controller read from the scenario.
    """
    scene = load_yaml(find_file('scenario', 'lamp_room'))
    up = {'at': '2 s', 'altitude': '0.8 m', 'heading': '30 deg', 'speed': '0.3 m/s'}
    scene['course'] = {
        'between': 'step',
        'rows': [up, {**up, 'at': '4 s', 'altitude': '0 m', 'speed': '0 m/s'}],
        'shake': {'duty': '20 %', 'hold': '0.3 s'},
    }
    path = tmp_path / 'course.yaml'
    path.write_text(yaml.safe_dump(scene))
    options = ('--seed', '4', '--json', '--out')
    changes = ('vehicle.trim.heaviness=4 g', 'scenario.goal.time_limit=6 s')
    words = [word for change in changes for word in ('--set', change)]
    loop = lta.run('simulate', *options, tmp_path / 'loop', '--scenario', path, *words)
    assert json.loads(loop.stdout)['outcome'] == 'reached', loop.stderr
    files = [f'--{root}={tmp_path / "loop" / root}.yaml' for root in ('vehicle', 'scenario')]
    graph = lta.run('fly', '--no-page', *options, tmp_path / 'graph', *files)
    assert json.loads(graph.stdout)['outcome'] == 'reached', graph.stderr
    one, two = (contents(tmp_path / name / 'bag') for name in ('graph', 'loop'))
    for topic in REPEATABLE:
        assert sorted(one[topic]) == sorted(two[topic]) != [], topic


@pytest.mark.long
def test_real_time_is_real_time(fly, call):
    """Or it is said that the machine cannot keep pace."""
    flown = fly('real', '--time', 'realtime', time_limit='5 s')
    assert flown['outcome'] == 'timeout'
    assert flown['pace'] < 1.02
    health = open_flight(flown['bag'])['/diagnostics']
    said = any('slower than real time' in str(text) for text in health.to_numpy().ravel())
    assert flown['pace'] > 0.94 or said
    check_one_clock(call, flown['bag'])
