# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Each node can be left out for somebody's own, and the simulator waits for the rest."""

from pathlib import Path

from lta_config.topics import load_topic_table
from lta_graph.launches import FLY
import pytest
import yaml

AWAITED = ['estimator', 'controller', 'demodulator', 'navigator', 'energy_monitor']


def flown(**given):
    """Return the parameters of each process by its name."""
    return {process.name: process.parameters for process in FLY.build_plan(given).processes}


def test_in_real_time_the_simulator_waits_for_what_is_started():
    assert flown()['simulator']['wait_for'].split() == [*AWAITED, 'description']


@pytest.mark.parametrize('name', AWAITED)
def test_what_is_left_out_is_not_waited_for(name):
    plan = flown(**{name: 'false'})
    assert set(flown()) - set(plan) == {name}
    rest = [each for each in AWAITED if each != name]
    assert plan['simulator']['wait_for'].split() == [*rest, 'description']


@pytest.mark.parametrize('name', AWAITED)
def test_in_lockstep_somebody_must_take_its_place(name):
    plan = flown(**{name: 'false', 'time': 'lockstep'})
    assert name not in plan
    assert plan['simulator']['wait_for'] == 'default description'


def test_a_description_that_is_left_out_is_not_waited_for():
    plan = flown(description='false', time='lockstep')
    assert 'description' not in plan
    assert plan['simulator']['wait_for'] == 'default'


def test_the_simulator_can_be_left_out_and_the_rest_stays():
    plan = flown(simulator='false')
    assert set(flown()) - set(plan) == {'simulator'}
    assert set(plan) - {'recorder', 'description'} == set(AWAITED)


def test_rviz_shows_the_robot_of_its_namespace_and_ends_no_flight():
    assert 'rviz' not in flown()
    plan = FLY.build_plan({'rviz': 'true', 'robot': 'blimp', 'processes': 'one'})
    (viewer,) = [process for process in plan.processes if process.package == 'rviz2']
    assert (viewer.namespace, viewer.on_exit_shutdown, viewer.shared) == ('/blimp', False, False)
    assert viewer.parameters == {'use_sim_time': True}
    option, path = viewer.words
    assert option == '-d'
    shown = yaml.safe_load(Path(path).read_text(encoding='utf-8'))['Visualization Manager']
    table = load_topic_table()
    kinds = {'MarkerArray': 'visualization_msgs', 'RobotModel': 'std_msgs', 'Odometry': 'nav_msgs'}
    found = set()
    for display in shown['Displays']:
        kind = display['Class'].removeprefix('rviz_default_plugins/')
        topic = display.get('Topic') or display.get('Description Topic')
        if topic is not None:
            row = table[topic['Value']]
            assert row.type.startswith(f'{kinds[kind]}/')
            assert (topic['Durability Policy'] == 'Transient Local') == (row.qos == 'latched')
            found.add(topic['Value'])
    assert found == {'scene', 'robot_description', 'odom', 'ground_truth/odom'}
