"""Motors past the firmware's supervisor: only tethered, and let go of on every way out."""

from lta_bridge.crazyflie.bridge_core import LETTING_GO
from lta_bridge.crazyflie.override import check_tether, select_expected_parameters
from lta_bridge.crazyflie.safety import SafetyRequest as AskedBy
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import REQUIRED
from lta_emulation.crazyflie.body import BenchBody
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer
import pytest
from waiting import wait_until

from .bridged import Bridged, DUTIES, FILE

pytestmark = [
    pytest.mark.filterwarnings('ignore::pytest.PytestUnraisableExceptionWarning'),
    pytest.mark.usefixtures('prompt_cflib'),
]

STILL = (0.0,) * 4


def overrides(flight):
    return [tuple(duties) for (duties,) in flight.kept.of('override_motors')]


EXITS = {
    'on request': lambda b: b.tick(AskedBy(arm=False)),
    'emergency stop': lambda b: b.tick(AskedBy(stop=True)),
    'commands end': lambda b: setattr(b, 'commands', False),
    'the drone is silent': lambda b: setattr(b, 'logs', False),
    'the link is gone': lambda b: setattr(b, 'linked', False),
    'deactivated': lambda b: setattr(b, 'active', False),
    'locked': lambda b: setattr(b, 'word', SupervisorBit.LOCKED),
    'disarmed by itself': lambda b: setattr(b, 'word', SupervisorBit.CAN_BE_ARMED),
}


@pytest.mark.parametrize('way', EXITS)
def test_on_every_way_out_the_motors_are_let_go_of_ten_times(way):
    flight = Bridged().fly()
    assert overrides(flight)[-1] == pytest.approx(DUTIES)
    EXITS[way](flight)
    for _ in range(100):  # 2 s: half a second of silence, and half of ramp
        flight.tick()
    assert overrides(flight)[-LETTING_GO:] == [()] * LETTING_GO
    assert len(overrides(flight)) < 90  # and then no more is said


def test_before_it_is_armed_nothing_is_overridden():
    flight = Bridged()
    for _ in range(100):
        flight.tick()
    assert not overrides(flight)


def test_the_drone_turns_them_though_disarmed_until_the_link_is_closed(linked):
    """What makes it dangerous, on the emulated firmware; and that closing ends it."""
    with CrazyflieServer(Firmware(BenchBody())) as server:
        link = linked(server)
        link.override_motors(DUTIES)
        body = server.firmware.body
        wanted = pytest.approx(DUTIES, abs=1e-4)
        wait_until(lambda: body.duties == wanted, 'the duties', lambda: body.duties)
        assert not server.firmware.supervisor.armed
        link.close()
        wait_until(lambda: body.duties == STILL, 'their end', lambda: body.duties)
        assert server.firmware.parameters.values['motorPowerSet.enable'] == 0


def test_duties_that_no_motor_has_are_clipped_and_break_nothing(linked):
    """Out of range on the topic would break the packet, while what was sent before turns on."""
    with CrazyflieServer(Firmware(BenchBody())) as server:
        link = linked(server)
        link.override_motors((2.0, -1.0, 0.5, 1.0))
        body, wanted = server.firmware.body, pytest.approx((1.0, 0.0, 0.5, 1.0), abs=1e-4)
        wait_until(lambda: body.duties == wanted, 'the duties', lambda: body.duties)
        link.close()


def test_an_emergency_stop_takes_the_override_off_whoever_put_it_on(linked):
    with CrazyflieServer(Firmware(BenchBody())) as server:
        link = linked(server)
        link.write_parameter('motorPowerSet.m1', 30000, 2.0)
        link.write_parameter('motorPowerSet.enable', 1, 2.0)
        body = server.firmware.body
        wait_until(lambda: body.duties[0] > 0.4, 'the duties', lambda: body.duties)
        link.send_emergency_stop()
        wait_until(lambda: body.duties == STILL, 'their end', lambda: body.duties)
        link.close()


def test_untethered_it_is_refused_and_no_app_is_asked_for():
    with pytest.raises(BadInput, match='tether the drone to a bench and add tethered:=true'):
        check_tether('override', tethered=False)
    check_tether('override', tethered=True)
    check_tether('motors', tethered=False)
    assert 'lta.app' in select_expected_parameters(FILE, 'motors')
    assert not any(
        name.startswith('lta.') for name in select_expected_parameters(FILE, 'override')
    )
    assert 'stabilizer.controller' not in select_expected_parameters(
        FILE, 'override'
    )  # stock firmware has no 6
    assert REQUIRED.keys() <= select_expected_parameters(FILE, 'override').keys()
