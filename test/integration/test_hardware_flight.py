# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The whole graph to the lamp through both bridges: a simulated world behind emulated hardware."""

import os
from pathlib import Path
import signal

from ports import free_port, UDP
import pytest
from std_srvs.srv import SetBool

from .command import ROOT
from .contents import check_one_clock
from .peer import Peer

ARM = 'crazyflie_bridge/arm'
READY = {  # who must have said what before anybody may arm
    'crazyflie_bridge: link': 'connected',
    'teensy_bridge: light board': 'receiving light',
    'estimator: estimate': 'biases are known',
    'navigator: mission': 'climb',
}
HEARD = {'demodulator: light': 'beacon found'}


@pytest.fixture
def near(tmp_path):
    """Return the shipped scene with a start 2.2 m from the lamp, which is reached at 1 m."""
    text = (ROOT / 'config/scenarios/lamp_room.yaml').read_text()
    path = tmp_path / 'near.yaml'
    path.write_text(text.replace('value: [-3.5, 0]', 'value: [1.3, 0]'))
    return path


@pytest.mark.long
@pytest.mark.parametrize(
    ('vehicle', 'command', 'finds_peaks'),
    [
        # In real time: beside other tests on two cores it once flew past the lamp
        ('gtmab', 'motors', False),
        # Faults in flight (test_fault_kinds.py) fly by setpoints too, and peaks come through the
        # board in test_light_emulated.py.
        ('multirotor', 'setpoint', True),
    ],
    ids=['motors-samples', 'setpoint-peaks'],
)
def test_through_both_bridges_it_finds_the_lamp_and_comes_down(
    lta, call, hear, domain_id, near, tmp_path: Path, vehicle, command, finds_peaks
):
    """
    In both command modes; the board of the second finds the peaks, without a demodulator.

    The first comes down because it is asked to, the second because it sees no light any more.
    """
    light = ('light_peaks:=true', 'beacon:=150.0') if finds_peaks else ()
    graph = lta.start(
        'launch',
        'emulated',
        f'vehicle:={vehicle}',
        f'command:={command}',
        f'scenario:={near}',
        f'port:={free_port(UDP)}',
        f'light_port:={tmp_path}/light_board',
        f'bag:={tmp_path}/bag',
        *light,
    )
    ready = READY if finds_peaks else READY | HEARD
    hear(lambda facts: all(n in facts and facts[n].message == word for n, word in ready.items()))
    assert 'took off' not in graph.text
    with Peer(domain_id) as pilot:
        pilot.arm_until(lambda: 'The drone reached the lamp' in graph.text)
        assert 'The drone took off, 2.2 m from the lamp' in graph.text
        if finds_peaks:  # the board's cable is pulled, and nobody asks
            os.kill(graph.node('emulated_hardware', robot=''), signal.SIGUSR1)
            why = 'disarmed: the newest command is'
        else:
            pilot.ask(SetBool, ARM, data=False)
            why = 'disarmed: on request'
        graph.said('The drone landed')
    hear(lambda facts: facts['crazyflie_bridge: safety'].message.startswith(why))
    graph.interrupt()
    assert graph.end() == 130, graph.text  # as after any Ctrl-C
    check_one_clock(call, tmp_path / 'bag')
    status, bag = call('bag', 'info', tmp_path / 'bag')
    assert status == 0
    counts = {line.split()[0]: line.split()[2] for line in bag.out.splitlines() if '/msg/' in line}
    for topic in ('imu', 'range', 'battery', 'light/estimate', 'setpoint/pose'):
        assert int(counts[f'/lta1/{topic}']) > 50
    assert (counts['/lta1/photodiodes'] == '0') == finds_peaks


@pytest.mark.long
@pytest.mark.parametrize('ending', ['Ctrl-C', 'navigator', 'controller'])
def test_the_launch_lands_its_drone_before_it_ends(
    lta, hear, domain_id, near, tmp_path: Path, ending
):
    """Whether by Ctrl-C or because a node died; the drone is not one of its processes."""
    port, light = free_port(UDP), tmp_path / 'light_board'
    drone = lta.start(
        'run', 'lta_emulation', 'emulated_hardware', '--vehicle', 'gtmab', '--scenario', near,
        '--port', str(port), '--light-port', light,
    )  # fmt: skip
    graph = lta.start(
        'launch', 'fly', 'source:=crazyflie', f'uri:=udp://127.0.0.1:{port}', 'command:=motors',
        f'scenario:={near}', 'light_board:=true', f'light_port:={light}', 'light_patience:=60.0',
        'record:=false',
    )  # fmt: skip
    ready = READY | HEARD
    hear(lambda facts: all(n in facts and facts[n].message == word for n, word in ready.items()))
    with Peer(domain_id) as pilot:
        pilot.arm_until(lambda: 'The drone took off' in drone.text)
    assert 'The drone landed' not in drone.text
    if ending == 'Ctrl-C':
        graph.interrupt()
    else:
        os.kill(graph.node(ending), signal.SIGKILL)
    hear(lambda facts: facts['crazyflie_bridge: safety'].message.startswith('disarmed'))
    drone.said('The drone landed')
    assert graph.end() == (130 if ending == 'Ctrl-C' else 1), graph.text
    drone.interrupt()
    drone.end()
