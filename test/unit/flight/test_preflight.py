# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A launch plan is checked before anything starts."""

from dataclasses import replace

from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_flight.preflight import check_plan
from lta_graph.launch_plan import LaunchPlan, LaunchProcess
from lta_graph.launches import EMULATED, FLEET, FLY
import pytest


def plan(package='lta_sim', **parameters):
    return LaunchPlan((LaunchProcess(package, 'node', 'node', parameters=parameters),))


REAL = {'source': 'crazyflie', 'robot': 'lta1'}


def test_a_board_that_is_missing_is_refused_before(tmp_path, monkeypatch):
    monkeypatch.setattr('lta_bridge.teensy.port.list_ports.comports', list)
    port = str(tmp_path / 'tty')
    words = {**REAL, 'bag': str(tmp_path / 'bag'), 'light_board': 'true', 'light_port': port}
    with pytest.raises(BadInput) as caught:
        check_plan(FLY.build_plan(words))
    sentence = f'There is no serial port {port}; plug the light board in (found: none).'
    assert str(caught.value) == sentence
    assert list(tmp_path.iterdir()) == []


def test_a_board_that_is_awaited_and_a_joystick_of_another_machine_need_not_be_there(tmp_path):
    waiting = {'light_board': 'true', 'light_port': '/dev/none', 'light_patience': '60.0'}
    listening = {'light_board': 'true', 'light_port': 'udp://127.0.0.1:5'}
    for words in (waiting, listening, {'teleop': 'true', 'teleop_device': 'joy'}):
        check_plan(FLY.build_plan({**REAL, 'bag': str(tmp_path / 'bag'), **words}))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ('seconds', 'found'), [(None, 'no sigterm_timeout'), (8.0, 'a sigterm_timeout of 8 s')]
)
def test_a_bridge_that_would_be_stopped_before_it_lands_its_drone_is_refused(seconds, found):
    bridge = LaunchProcess('lta_bridge', 'crazyflie_bridge', 'bridge')
    with pytest.raises(BadInput, match=f'^The node bridge has {found}, but lands .* 20 s after'):
        check_plan(LaunchPlan((replace(bridge, sigterm_timeout=seconds),)))
    check_plan(LaunchPlan((replace(bridge, sigterm_timeout=20.0),)))
    check_plan(FLY.build_plan({'source': 'crazyflie'}))
    check_plan(EMULATED.build_plan({}))


def test_two_controllers_of_one_drone_are_refused(tmp_path):
    """The firmware's and ours, which is never armed: a take-off would end as a fault."""
    (tmp_path / 'mine.yaml').write_text(find_file('vehicle', 'gtmab').read_text())
    text = find_file('crazyflie', 'gtmab').read_text()
    beside = tmp_path / 'mine.crazyflie.yaml'
    beside.write_text(text.replace('command: motors', 'command: setpoint'))
    mine = {**REAL, 'vehicle': str(tmp_path / 'mine.yaml'), 'bag': str(tmp_path / 'bag')}
    for name, words in (('gtmab', mine), ('multirotor', {**mine, 'vehicle': 'multirotor'})):
        with pytest.raises(BadInput) as caught:
            check_plan(FLY.build_plan(words))
        assert str(caught.value) == (
            f'The Crazyflie of {name} is commanded by setpoints, which its own firmware follows, '
            'but controller is to start too; add command:=setpoint or controller:=false.'
        )
        for way_out in ({'command': 'setpoint'}, {'controller': 'false'}):
            check_plan(FLY.build_plan(words | way_out))
    # Duties on request, and a drone that only exists in the simulator
    check_plan(FLY.build_plan(mine | {'command': 'motors'}))
    check_plan(FLY.build_plan(mine | {'source': 'sim'}))
    beside.write_text(text)
    check_plan(FLY.build_plan(mine))


@pytest.mark.parametrize(
    ('words', 'armed'),
    [
        ({}, True),
        ({'source': 'replay', 'replay': 'flown'}, True),  # its motors move nothing
        ({'simulator': 'false'}, False),  # a bridge of one's own: motors in somebody's hands
        ({'source': 'crazyflie'}, False),
    ],
)
def test_only_a_simulated_drone_starts_armed(words, armed):
    processes = FLY.build_plan(words).processes
    (controller,) = [each for each in processes if each.executable == 'controller']
    assert controller.parameters['armed'] is armed


@pytest.fixture
def other(tmp_path):
    """Return the file of a scene whose lamp flickers at 230 Hz."""
    path = tmp_path / 'other.yaml'
    path.write_text(find_file('scenario', 'lamp_room').read_text().replace('150 Hz', '230 Hz'))
    return path


@pytest.mark.parametrize('launch', [FLY, FLEET], ids=['fly', 'fleet'])
def test_a_lamp_that_nobody_listens_for_is_refused_for_every_drone(launch, other):
    check_plan(launch.build_plan({}))
    with pytest.raises(BadInput, match='flickers at 230 Hz, but the demodulator listens at 150'):
        check_plan(launch.build_plan({'scenario': str(other)}))


def test_a_demodulator_that_is_set_to_the_lamp_hears_it(other):
    navigator = LaunchProcess(
        'lta_control', 'navigator', 'navigator', '/a', parameters={'scenario': str(other)}
    )
    for own, heard in [
        ({'parameters': {'frequency': 230.0}}, True),
        ({'parameter_file': 'own.yaml'}, True),
        ({}, False),
    ]:
        listener = LaunchProcess('lta_vlc', 'demodulator', 'demodulator', '/a', **own)
        plan = LaunchPlan((navigator, listener))
        if heard:
            check_plan(plan)
            continue
        with pytest.raises(BadInput, match='flickers at 230 Hz'):
            check_plan(plan)


def test_two_nodes_of_one_name_are_refused():
    plan = FLY.build_plan({})
    with pytest.raises(BadInput) as caught:
        check_plan(LaunchPlan(plan.processes * 2))
    assert str(caught.value).startswith("2 nodes have the name '/lta1/simulator'; give each robot")
