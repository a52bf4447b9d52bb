# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""To whom `lta launch` hands a launch file, and what names whom."""

from lta_bridge.crazyflie.safety import LEAVE
from lta_cli.verbs import launch
from lta_flight import stall_watchdog
from lta_flight.stall_watchdog import FLIGHT, StallMonitor
from lta_graph.health import HealthFact, HealthLevel
from lta_graph.launches import FLY
import pytest

NOTHING = """
from lta_config.settings import Settings
from lta_graph.launch_plan import Launch
LAUNCH = Launch('none', Settings, lambda _: [])
"""


class Handed(Exception):
    """Stands in for the program that takes the process over."""


@pytest.fixture
def handed(monkeypatch, tmp_path):
    """Return what would be executed, with a ros2 on the path and a plan that loads."""

    def execute(program, words):
        raise Handed(program, *words)

    def run(plan, on_line, say):
        raise Handed('ourselves')

    monkeypatch.setattr(launch.os, 'execvp', execute)
    monkeypatch.setattr(launch.shutil, 'which', lambda name: f'/opt/ros/bin/{name}')
    monkeypatch.setattr(launch, 'run_graph', run)
    path = tmp_path / 'none.launch.py'
    path.write_text(NOTHING)
    return path


def test_over_an_installed_ros_the_genuine_launch_does_it(handed, monkeypatch):
    monkeypatch.delenv('LTA_UNDERLAY', raising=False)
    with pytest.raises(Handed) as taken:
        launch.launch(str(handed), [])
    assert taken.value.args == ('ros2', 'ros2', 'launch', str(handed))


def test_over_the_wheels_we_do(handed, monkeypatch):
    monkeypatch.setenv('LTA_UNDERLAY', 'wheels')
    with pytest.raises(Handed) as taken:
        launch.launch(str(handed), [])
    assert taken.value.args == ('ourselves',)


@pytest.fixture
def clock(monkeypatch):
    """Return a list whose only item is the time [s]."""
    now = [100.0]
    monkeypatch.setattr(stall_watchdog.time, 'monotonic', lambda: now[0])
    return now


@pytest.mark.usefixtures('clock')
def test_whoever_falls_silent_is_named_once():
    said = []
    lookout = StallMonitor(said.append)
    for silent in ([], ['estimator'], ['estimator'], [], ['navigator']):
        lookout.report_stalled_nodes({}, silent)
    assert said == ['No messages arrive from estimator.', 'No messages arrive from navigator.']


def test_after_the_flight_nobody_is_named_though_the_graph_stands(clock):
    said = []
    lookout = StallMonitor(said.append)
    over = HealthFact(FLIGHT, HealthLevel.OK, 'reached', {'outcome': 'reached'})
    lookout.report_stalled_nodes({FLIGHT: over}, [])
    clock[0] += 3.0
    lookout.report_stalled_nodes({FLIGHT: over}, ['simulator'])
    assert said == []
    assert lookout.stall_duration == 3.0


@pytest.mark.usefixtures('clock')
def test_a_robot_that_is_there_is_not_blamed_for_standing_and_the_other_still_is():
    said = []
    lookout = StallMonitor(said.append)
    facts = {
        f'lta1/{FLIGHT}': HealthFact(f'lta1/{FLIGHT}', HealthLevel.OK, '', {'outcome': 'reached'}),
        f'lta2/{FLIGHT}': HealthFact(f'lta2/{FLIGHT}', HealthLevel.OK, '', {'outcome': 'flying'}),
    }
    lookout.report_stalled_nodes(facts, ['lta1/simulator'])
    lookout.report_stalled_nodes(facts, ['lta1/simulator', 'lta2/estimator'])
    lookout.report_stalled_nodes(facts, ['recorder'])
    assert said == ['No messages arrive from lta2/estimator.', 'No messages arrive from recorder.']
    over = dict.fromkeys(facts, facts[f'lta1/{FLIGHT}'])
    lookout.report_stalled_nodes(over, ['simulator'])  # which is of both
    assert len(said) == 2


def test_who_still_loads_is_excused_and_named_only_once_it_has_spoken(clock):
    said = []
    lookout = StallMonitor(said.append)
    waits = HealthFact('estimator: inputs', HealthLevel.ERROR, '', {'suspects': 'vehicle'})
    for _ in range(60):
        lookout.report_stalled_nodes({waits.task: waits}, [], unheard=['simulator'])
        clock[0] += 1.0
    assert lookout.stall_duration == 0.0
    (sentence,) = said
    assert sentence.startswith('Waiting for vehicle to load; the first flight compiles')
    for _ in range(3):
        lookout.report_stalled_nodes({waits.task: waits}, [])
        clock[0] += 1.0
    assert said[1:] == ['No messages arrive from vehicle.']
    assert lookout.stall_duration == 3.0


def test_before_the_first_step_nobody_says_that_it_waits_and_the_model_is_still_excused(clock):
    said = []
    lookout = StallMonitor(said.append)
    for _ in range(60):
        lookout.report_stalled_nodes({}, [], unheard=['lta2/simulator', 'theirs'])
        clock[0] += 1.0
    (sentence,) = said
    assert sentence.startswith('Waiting for lta2/vehicle to load; the first flight compiles')


@pytest.mark.usefixtures('clock')
def test_faults_of_nodes_are_said_but_for_those_with_sentences_of_their_own():
    said, told = [], []
    lookout = StallMonitor(said.append, told.append)
    facts = [
        HealthFact('estimator: inputs', HealthLevel.ERROR, 'waiting for imu', {'suspects': ''}),
        HealthFact('launcher: processes', HealthLevel.ERROR, 'No messages arrive from estimator.'),
        HealthFact('recorder: recording', HealthLevel.ERROR, 'The disk is full: make room.'),
    ]
    lookout.report_stalled_nodes({fact.task: fact for fact in facts}, ['estimator'])
    assert said == told == ['No messages arrive from estimator.']
    for _ in range(2):
        lookout.report_health(facts)
    assert said[1:] == ['recorder: recording: The disk is full: make room.']
    assert len(told) == 1  # the node says it itself


def test_a_real_drone_gets_the_time_to_land_and_the_recorder_sees_it():
    plan = FLY.build_plan({'source': 'crazyflie'})
    times = {item.name: item.sigterm_timeout for item in plan.processes}
    # It lands, then the keeper of its link has 5 s to close it.
    assert min(times.pop('crazyflie_bridge'), times.pop('recorder')) > LEAVE + 5.0
    assert set(times.values()) == {None}
