# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Several drones from one launch: each the graph of one, with one simulator and one recorder."""

from pathlib import Path

from lta_bridge.parameters import RecorderSettings, RobotOrigin
from lta_config.errors import BadInput
from lta_flight.preflight import check_plan
from lta_graph.launches import FLEET, FLY
from lta_graph.ros.node import GraphSettings
from lta_graph.ros.parameters import iterate_fields
from lta_sim.drone import DroneSettings, SimulatorSettings
import pytest

ROOT = Path(__file__).resolve().parents[2]


def nodes(launch, **given):
    """Return the parameters of each process by the plan's name for it."""
    plan = launch.build_plan(given)
    return {plan.label(process): dict(process.parameters) for process in plan.processes}


def test_each_drone_is_the_graph_of_one_but_for_simulator_and_recorder():
    fleet = nodes(FLEET, seed='7', offset_y='0.5', time='lockstep')
    assert len(fleet) == 2 * 6 + 2
    for robot, seed, offset in (('lta1', '7', '0.5'), ('lta2', '8', '-1.0')):
        own = {'robot': robot, 'seed': seed, 'offset_y': offset, 'frame_prefix': f'{robot}/'}
        alone = nodes(FLY, time='lockstep', **own)
        simulated = alone.pop('simulator')
        del alone['recorder'], simulated['frame_prefix']
        for name, expected in alone.items():
            assert fleet[f'{robot}/{name}'] == expected, (robot, name)
        found = fleet['simulator']
        for name, expected in simulated.items():
            assert found.get(f'{robot}.{name}', found.get(name)) == expected, (robot, name)


def test_ten_drones_have_a_place_and_a_seed_each_in_the_room():
    plan = FLEET.build_plan({'n': '10', 'offset_x': '0.25'})
    check_plan(plan)
    assert len(plan.processes) == 10 * 6 + 2
    (found,) = [each.parameters for each in plan.processes if each.name == 'simulator']
    robots = [f'lta{k + 1}' for k in range(10)]
    assert found['robots'].split() == robots
    assert [found[f'{each}.seed'] for each in robots] == list(range(1, 11))
    across = [0.0, -1.5, 1.5, -3.0, 3.0]
    assert [found[f'{each}.offset_y'] for each in robots] == across * 2
    assert [found[f'{each}.offset_x'] for each in robots] == [0.25] * 5 + [1.75] * 5


@pytest.mark.parametrize('count', ['0', '11', 'two'])
def test_other_numbers_of_drones_are_refused(count):
    with pytest.raises(BadInput, match=rf"^The launch argument n is '?{count}'?, but must be "):
        FLEET.build_plan({'n': count})


def test_vehicles_and_strategies_take_turns():
    plan = FLEET.build_plan({'n': '3', 'vehicle': 'gtmab,skye', 'gains': 'gtmab,skye'})
    found = {plan.label(each): each for each in plan.processes}
    vehicles = [found['simulator'].parameters[f'lta{k}.vehicle'] for k in (1, 2, 3)]
    assert vehicles == ['gtmab', 'skye', 'gtmab']
    assert found['lta2/controller'].parameter_file.endswith('control/skye.yaml')
    assert found['lta3/controller'].parameter_file.endswith('control/gtmab.yaml')
    assert found['recorder'].parameters['lta2.gains'].endswith('control/skye.yaml')
    assert found['recorder'].parameters['lta3.vehicle'] == 'gtmab'


@pytest.mark.parametrize(
    ('node', 'settings', 'model'),
    [
        ('recorder', RecorderSettings, RobotOrigin),
        ('simulator', SimulatorSettings, DroneSettings),
    ],
)
def test_who_serves_both_is_told_all_of_both_and_knows_every_word(node, settings, model):
    own = {key for key, _, _ in [*iterate_fields(settings()), *iterate_fields(GraphSettings())]}
    each = {key for key, _, _ in iterate_fields(model())}
    given = nodes(FLEET, robot='a', vehicle='gtmab,2026-11-20')[node]
    assert given['robots'] == 'a1 a2'
    assert given['a2.vehicle'] == '2026-11-20'
    assert {f'{robot}.{key}' for robot in ('a1', 'a2') for key in each} <= set(given)
    assert {key.rpartition('.')[2] for key in given} - {'use_sim_time'} <= own
    for robot in ('a1', 'a2'):
        told = {key: given[f'{robot}.{key}'] for key in each}
        assert {key: type(value) for key, value in told.items()} == {
            key: type(value) for key, _, value in iterate_fields(model())
        }


def test_each_has_a_live_view_of_its_own_where_one_is_asked_for():
    assert not any('live' in name.split('/') for name in nodes(FLEET))
    found = nodes(FLEET, live='true', live_port='9000')
    alone = nodes(FLY, live='true', live_port='9000', frame_prefix='lta1/')['live']
    assert found['lta1/live'] == alone
    assert found['lta2/live'] == {**alone, 'frame_prefix': 'lta2/', 'port': 9001}


def test_the_end_of_the_simulator_ends_the_launch():
    plan = FLEET.build_plan({})
    assert {item.name for item in plan.processes if not item.on_exit_shutdown} == {'description'}
    ending = [item for item in plan.processes if item.planned]
    assert [(item.namespace, item.name) for item in ending] == [('/', 'simulator')]


def test_the_first_is_the_flight_that_people_know_and_all_are_checked_beforehand():
    given = {item.name: item for item in FLEET.list_arguments()}
    alone = {item.name: item for item in FLY.list_arguments()}
    for name in ('vehicle', 'gains', 'strategy', 'seed', 'offset_x', 'offset_y'):
        assert given[name].default == alone[name].default, name
    assert all(item.description.endswith('.') for item in given.values())
    check_plan(FLEET.build_plan({}))
    for words, sentence in (
        ({'vehicle': 'gtmab,nope'}, "Unknown vehicle 'nope'"),
        ({'seed': '-1'}, 'The seed is -1'),
        ({'spacing': '9'}, 'outside the room'),
    ):
        with pytest.raises(BadInput, match=sentence):
            check_plan(FLEET.build_plan(words))
