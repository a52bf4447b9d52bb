"""Reconnection to a Crazyflie and the writes at connect, without a thread or a drone."""

from lta_bridge.crazyflie.connection_manager import enforce_parameters
from lta_bridge.crazyflie.link import LinkFailed
from lta_bridge.crazyflie.udp_probe import is_port_closed
from lta_config.schema.crazyflie_file import ExpectedParameter
from lta_emulation.crazyflie.body import BenchBody
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer


class Drone:
    """A link that records its calls and fails to open on request."""

    def __init__(self, parameters=None, fails=()):
        self.parameters, self.fails = parameters or {}, iter(fails)
        self.opened, self.written, self.closed = [], [], 0

    def open(self, deadline):
        self.opened.append(deadline)
        if next(self.fails):
            raise LinkFailed(f'try {len(self.opened)}')

    def read_parameter(self, name):
        return self.parameters.get(name)

    def write_parameter(self, name, value, deadline):
        self.written.append((name, value, deadline))

    def close(self):
        self.closed += 1


def test_a_port_is_closed_until_a_program_listens():
    with CrazyflieServer(Firmware(BenchBody(), drift=0.0)) as drone:
        assert not is_port_closed(drone.uri)
    assert is_port_closed(drone.uri)
    assert not is_port_closed('radio://0/80/2M/E7E7E7E7E7')


def want(value, write=True):
    return ExpectedParameter(value=value, write=write, why='why')


def test_what_turns_motors_is_switched_off_first_and_what_is_right_is_left():
    drone = Drone({'motorPowerSet.enable': 1.0, 'powerDist.idleThrust': 0.0, 'a': 1.0, 'b': 2.0})
    enforce_parameters(drone, {'a': want(1.0, write=False), 'b': want(3.0)})
    assert drone.written == [('motorPowerSet.enable', 0.0, 2.0), ('b', 3.0, 2.0)]
