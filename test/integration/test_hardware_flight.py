"""The whole graph to the lamp through both bridges: a simulated world behind emulated hardware."""

from pathlib import Path
import socket

import pytest
from std_srvs.srv import SetBool

from .conftest import ROOT
from .peer import Peer

ARM = 'crazyflie_bridge/arm'
READY = {  # who must have said what before anybody may arm
    'crazyflie_bridge: link': 'connected',
    'teensy_bridge: light board': 'light comes',
    'estimator: estimate': 'biases are known',
    'demodulator: light': 'beacon found',
    'navigator: mission': 'climb',
}


@pytest.fixture
def near(tmp_path):
    """Return the shipped scene with a start that is nearer: 4 m from the lamp, 1 m to reach it."""
    text = (ROOT / 'config/scenarios/lamp_room.yaml').read_text()
    path = tmp_path / 'near.yaml'
    path.write_text(text.replace('value: [-3.5, 0]', 'value: [-0.5, 0]'))
    return path


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


@pytest.mark.parametrize(('vehicle', 'command'), [('gtmab', 'motors'), ('multirotor', 'setpoint')])
def test_through_both_bridges_it_finds_the_lamp_and_comes_down(
    lta, hear, domain_id, near, tmp_path: Path, vehicle, command
):
    graph = lta.start(
        'launch',
        'emulated',
        f'vehicle:={vehicle}',
        f'command:={command}',
        f'scenario:={near}',
        f'port:={free_port()}',
        f'light_port:={tmp_path}/light_board',
        f'bag:={tmp_path}/bag',
    )
    hear(lambda facts: all(n in facts and facts[n].message == word for n, word in READY.items()))
    assert 'took off' not in graph.text
    with Peer(domain_id) as pilot:
        armed = pilot.ask(SetBool, ARM, data=True)
        assert armed.success, armed.message
        graph.said('It took off, 4.0 m from the lamp')
        graph.said('It reached the lamp')
        pilot.ask(SetBool, ARM, data=False)
        graph.said('It stands')
    hear(lambda facts: facts['crazyflie_bridge: safety'].message.startswith('disarmed: '))
    graph.interrupt()
    assert graph.end() == 0, graph.text
    bag = lta.run('bag', 'info', tmp_path / 'bag')
    assert bag.returncode == 0
    for topic in ('imu', 'range', 'battery', 'photodiodes', 'light/estimate', 'setpoint/pose'):
        assert f'/lta1/{topic} ' in bag.stdout
