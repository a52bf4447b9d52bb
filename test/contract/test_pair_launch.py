"""Two drones from one launch file: each the graph of one, one recorder, one who tells the time."""

from pathlib import Path

from lta_bridge.nodes.recorder import RecorderSettings, RobotOrigin
from lta_config.errors import BadInput
from lta_flight.preflight import check_plan
from lta_graph.launches import FLY, PAIR
from lta_graph.ros.node import GraphSettings
from lta_graph.ros.parameters import iterate_fields
import pytest

ROOT = Path(__file__).resolve().parents[2]
ROBOTS = ('lta1', 'lta2')


def nodes(launch, **given):
    """Return the parameters of each process by the plan's name for it."""
    plan = launch.build_plan(given)
    return {plan.label(process): dict(process.parameters) for process in plan.processes}


def test_each_drone_is_the_graph_of_one_but_for_recorder_clock_and_peers():
    pair = nodes(PAIR, seed2='7', offset_y2='-1.5', time='lockstep')
    assert len(pair) == 2 * 7 + 1
    for robot, seed, offset in (('lta1', '1', '0.0'), ('lta2', '7', '-1.5')):
        own = {'robot': robot, 'seed': seed, 'offset_y': offset, 'frame_prefix': f'{robot}/'}
        alone = nodes(FLY, time='lockstep', **own)
        del alone['recorder']
        for name, expected in alone.items():
            found = pair[f'{robot}/{name}']
            if name == 'simulator':
                other = ROBOTS[1 - ROBOTS.index(robot)]
                assert (found.pop('clock'), found.pop('peers')) == (robot == 'lta1', other)
                assert (expected.pop('clock'), expected.pop('peers')) == (True, '')
            assert found == expected, (robot, name)


def test_the_gains_of_each_go_to_its_controller_and_into_the_bag(tmp_path):
    gains = tmp_path / 'gains.yaml'
    gains.write_bytes((ROOT / 'config/control/gtmab.yaml').read_bytes())
    plan = PAIR.build_plan({'gains2': str(gains)})
    processes = {plan.label(process): process for process in plan.processes}
    assert processes['lta2/controller'].parameter_file == str(gains)
    assert processes['lta1/controller'].parameter_file.endswith('control/gtmab.yaml')
    assert processes['recorder'].parameters['lta2.gains'] == str(gains)


def test_the_recorder_is_told_all_of_both_and_knows_every_word():
    own = {
        key
        for key, _, _ in [*iterate_fields(RecorderSettings()), *iterate_fields(GraphSettings())]
    }
    each = {key for key, _, _ in iterate_fields(RobotOrigin())}
    given = nodes(PAIR, robot1='a', robot2='b', vehicle2='2026-11-20')['recorder']
    assert given['robots'] == 'a b'
    assert given['b.vehicle'] == '2026-11-20'
    assert {f'{robot}.{key}' for robot in 'ab' for key in each} <= set(given)
    assert {key.rpartition('.')[2] for key in given} - {'use_sim_time'} <= own
    for robot in 'ab':
        told = {key: given[f'{robot}.{key}'] for key in each}
        assert {key: type(value) for key, value in told.items()} == {
            key: type(value) for key, _, value in iterate_fields(RobotOrigin())
        }


def test_without_a_recording_nobody_waits_for_a_recorder():
    found = nodes(PAIR, record='false')
    assert 'recorder' not in found
    assert all(found[f'{robot}/simulator']['record'] is False for robot in ROBOTS)


def test_each_has_a_live_view_of_its_own_where_one_is_asked_for():
    assert not any('live' in name.split('/') for name in nodes(PAIR))
    found = nodes(PAIR, live='true', live_port2='9000')
    alone = nodes(FLY, live='true', frame_prefix='lta1/')['live']
    assert found['lta1/live'] == alone
    assert found['lta2/live'] == {**alone, 'frame_prefix': 'lta2/', 'port': 9000}
    ports = {item.name: item.default for item in PAIR.list_arguments() if 'port' in item.name}
    assert ports['live_port1'] != ports['live_port2']


def test_the_frames_of_each_have_its_name():
    found = nodes(PAIR, robot2='other')
    for name in {name.rpartition('/')[2] for name in found} - {'recorder'}:
        assert found[f'lta1/{name}']['frame_prefix'] == 'lta1/'
        assert found[f'other/{name}']['frame_prefix'] == 'other/'


def test_the_end_of_either_simulator_ends_the_launch_for_each_waits_for_the_other():
    plan = PAIR.build_plan({})
    assert {item.name for item in plan.processes if not item.on_exit_shutdown} == {'description'}
    ending = [item for item in plan.processes if item.planned]
    assert [(item.namespace, item.name) for item in ending] == [
        ('/lta1', 'simulator'),
        ('/lta2', 'simulator'),
    ]


def test_the_first_is_the_flight_that_people_know_and_both_are_checked_beforehand():
    given = {item.name: item for item in PAIR.list_arguments()}
    alone = {item.name: item for item in FLY.list_arguments()}
    for name in ('vehicle', 'gains', 'strategy', 'seed', 'offset_x', 'offset_y', 'robot'):
        assert given[f'{name}1'].default == alone[name].default, name
    assert all(item.description.endswith('.') for item in given.values())
    check_plan(PAIR.build_plan({}))
    for words, sentence in (
        ({'vehicle2': 'nope'}, "Unknown vehicle 'nope'"),
        ({'seed2': '-1'}, 'The seed is -1'),
        ({'offset_y1': '9'}, 'outside the room'),
    ):
        with pytest.raises(BadInput, match=sentence):
            check_plan(PAIR.build_plan(words))
