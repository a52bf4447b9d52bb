"""Motors past the firmware's supervisor: only tethered, and let go of on every way out."""

from lta_bridge.crazyflie.bridge import Asked, Bridge, LETTING_GO
from lta_bridge.crazyflie.emulated.body import Bench
from lta_bridge.crazyflie.emulated.firmware import Firmware
from lta_bridge.crazyflie.emulated.server import Server
from lta_bridge.crazyflie.link import LogPacket
from lta_bridge.crazyflie.override import check_tether, expected
from lta_bridge.crazyflie.safety import Asked as AskedBy
from lta_bridge.crazyflie.safety import Stage
from lta_bridge.crazyflie.supervisor import Bit
from lta_config.crazyflie_file import load_crazyflie
from lta_config.errors import BadInput
import pytest

pytestmark = pytest.mark.filterwarnings('ignore::pytest.PytestUnraisableExceptionWarning')

FILE = load_crazyflie('gtmab')
DUTIES = (0.1, 0.2, 0.3, 0.4)
STILL = (0.0,) * 4
TICK = 20_000_000  # ns
NOTHING = AskedBy()


class Told:
    """A link that keeps what the override was told; everything else is forgotten."""

    def __init__(self):
        self.overrides = []

    def override(self, duties):
        self.overrides.append(tuple(duties))

    def __getattr__(self, name):
        return lambda *_, **__: None


class Bridged:
    """A bridge in flight by override, at a clock of its own."""

    def __init__(self):
        self.told, self.now, self.word = Told(), 0, Bit.ARMED
        self.bridge = Bridge(self.told, FILE, list(FILE.motors.values()), 'override')
        self.linked = self.active = self.commands = self.logs = True
        self.tick(AskedBy(arm=True))
        for _ in range(3):
            self.tick()
        assert self.bridge.state.stage is Stage.FLYING

    def tick(self, asked=NOTHING):
        self.now += TICK
        if self.logs:
            values = {f'motor.m{n}': 0.0 for n in range(1, 5)} | {'supervisor.info': self.word}
            power = {'pm.vbat': 4.0, 'pm.state': 0}
            for name, told in (('motors', values), ('power', power)):
                self.bridge.heard(LogPacket(name, self.now // 1_000_000, told, self.now))
        if self.commands:
            self.bridge.commanded(Asked(self.now, duties=DUTIES))
        self.bridge.tick(1e-9 * self.now, self.now, self.linked, self.active, asked)


EXITS = {
    'asked to': lambda b: b.tick(AskedBy(arm=False)),
    'emergency stop': lambda b: b.tick(AskedBy(stop=True)),
    'commands end': lambda b: setattr(b, 'commands', False),
    'the drone is silent': lambda b: setattr(b, 'logs', False),
    'the link is gone': lambda b: setattr(b, 'linked', False),
    'deactivated': lambda b: setattr(b, 'active', False),
    'locked': lambda b: setattr(b, 'word', Bit.LOCKED),
    'disarmed by itself': lambda b: setattr(b, 'word', Bit.CAN_BE_ARMED),
}


@pytest.mark.parametrize('way', EXITS)
def test_on_every_way_out_the_motors_are_let_go_of_ten_times(way):
    flight = Bridged()
    assert flight.told.overrides[-1] == pytest.approx(DUTIES)
    EXITS[way](flight)
    for _ in range(100):  # 2 s: half a second of silence, and half of ramp
        flight.tick()
    assert flight.told.overrides[-LETTING_GO:] == [()] * LETTING_GO
    assert len(flight.told.overrides) < 90  # and then no more is said


def test_before_it_is_armed_nothing_is_overridden():
    told = Told()
    bridge = Bridge(told, FILE, list(FILE.motors.values()), 'override')
    for turn in range(100):
        bridge.commanded(Asked(turn * TICK, duties=DUTIES))
        bridge.tick(1e-9 * turn * TICK, turn * TICK, True, True, AskedBy())
    assert not told.overrides


def test_the_drone_turns_them_though_disarmed_until_the_link_is_closed(until, linked):
    """What makes it dangerous, on the emulated firmware; and that closing ends it."""
    with Server(Firmware(Bench())) as server:
        link = linked(server)
        link.override(DUTIES)
        until(lambda: server.firmware.body.duties == pytest.approx(DUTIES, abs=1e-4))
        assert not server.firmware.supervisor.armed
        link.close()
        until(lambda: server.firmware.body.duties == STILL)
        assert server.firmware.parameters.values['motorPowerSet.enable'] == 0


def test_duties_that_no_motor_has_are_clipped_and_break_nothing(until, linked):
    """Out of range on the topic would break the packet, while what was sent before turns on."""
    with Server(Firmware(Bench())) as server:
        link = linked(server)
        link.override((2.0, -1.0, 0.5, 1.0))
        until(lambda: server.firmware.body.duties == pytest.approx((1.0, 0.0, 0.5, 1.0), abs=1e-4))
        link.close()


def test_an_emergency_stop_takes_the_override_off_whoever_put_it_on(until, linked):
    with Server(Firmware(Bench())) as server:
        link = linked(server)
        link.write('motorPowerSet.m1', 30000, 2.0)
        link.write('motorPowerSet.enable', 1, 2.0)
        until(lambda: server.firmware.body.duties[0] > 0.4)
        link.stop()
        until(lambda: server.firmware.body.duties == STILL)
        link.close()


def test_untethered_it_is_refused_and_no_app_is_asked_for():
    with pytest.raises(BadInput, match='tether the drone to a bench and add tethered:=true'):
        check_tether('override', tethered=False)
    check_tether('override', tethered=True)
    check_tether('motors', tethered=False)
    assert 'lta.app' in expected(FILE, 'motors')
    assert not any(name.startswith('lta.') for name in expected(FILE, 'override'))
    assert expected(FILE, 'override')['motorPowerSet.enable'].value == 0
