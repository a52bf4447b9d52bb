# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The Crazyflie bridge: battery, setpoints, reports of its state, and the watchdog it feeds."""

from itertools import pairwise
import math

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_bridge.crazyflie import readings
from lta_bridge.crazyflie.bridge_core import BridgeCore, CrazyflieCommand, PositionEstimate
from lta_bridge.crazyflie.drone_operation import describe_health
from lta_bridge.crazyflie.messages import CrazyfliePowerModel
from lta_bridge.crazyflie.safety import LOW_VOLTAGE_TIME, SafetyInputs, SafetyStage, SafetyState
from lta_bridge.crazyflie.safety import SafetyRequest as AskedBy
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_config.schema.crazyflie_file import load_crazyflie
from lta_control.estimator import STUCK
from lta_graph.health import HealthLevel
from lta_model.electrical.loads import BENCH
from lta_model.vehicle import load_vehicle
import pytest

from .bridged import Bridged, FILE, NOTHING, TICK


@pytest.mark.parametrize(('state', 'low'), [(0, 0), (1, 0), (2, 0), (3, 1), (4, 1)])
def test_a_cell_that_the_firmware_itself_calls_low_lands_and_arms_nothing(state, low):
    """pm.h: on battery, charging, charged, low power, shut down."""
    flight = Bridged().fly()
    flight.power = {'pm.vbat': 4.0, 'pm.state': state}
    for _ in range(round(1e9 * LOW_VOLTAGE_TIME / TICK) + 2):
        flight.tick()
    assert flight.stage is (SafetyStage.LANDING if low else SafetyStage.FLYING)
    ground = Bridged()
    ground.power = flight.power
    ground.tick()
    assert ('charge it' in ground.bridge.find_arming_refusal(ground.now, True, True)) == bool(low)


@pytest.mark.parametrize(
    ('left', 'rate'), [(0.4, 0.6), (-0.4, -0.6), (2.0, 1.0), (-3.1, -1.0), (3.1, 1.0)]
)
def test_a_heading_is_turned_to_in_proportion_and_never_faster_than_one_radian_a_second(
    left, rate
):
    flight = Bridged('setpoint')
    flight.asked = CrazyflieCommand(0, speed=0.3, turn=left, height=1.2)
    flight.fly()
    assert flight.kept.of('send_hover_setpoint')[-1] == pytest.approx((0.3, rate, 1.2))


@pytest.mark.parametrize(
    ('speed', 'height', 'sent'),
    [(5.0, 99.0, (2.0, FILE.limits.height.si)), (-5.0, -1.0, (-2.0, 0.0))],
)
def test_a_setpoint_is_sent_within_the_limits(speed, height, sent):
    flight = Bridged('setpoint')
    flight.asked = CrazyflieCommand(0, speed=0.0, height=1.0)
    flight.fly()
    flight.asked = CrazyflieCommand(0, speed=speed, height=height)
    flight.tick()
    assert flight.kept.of('send_hover_setpoint')[-1] == (sent[0], 0.0, sent[1])


def test_armed_at_rest_no_setpoint_is_sent_until_one_above_the_floor():
    """The firmware's controller would start the motors in the hands of who carries the drone."""
    flight, rest = Bridged('setpoint'), CrazyflieCommand(0, height=0.3)
    for _ in range(2):
        before = len(flight.kept.of('send_hover_setpoint'))
        flight.asked = rest
        flight.fly()
        for _ in range(50):
            flight.tick()
        assert len(flight.kept.of('send_hover_setpoint')) == before
        flight.asked = CrazyflieCommand(0, height=1.0)
        flight.tick()
        flight.asked = rest
        flight.tick()
        assert [height for *_, height in flight.kept.of('send_hover_setpoint')[before:]] == [
            1.0, 0.3,
        ]  # fmt: skip
        flight.tick(AskedBy(arm=False))
        while flight.stage is not SafetyStage.DISARMED:
            flight.tick()


@pytest.mark.parametrize('rises', [False, True])
def test_a_drone_that_never_rose_is_not_told_to_land(rises):
    """The firmware would start the motors for it, at the height that it takes for its own."""
    flight = Bridged('setpoint')
    flight.asked = CrazyflieCommand(0, height=1.0 if rises else 0.3)
    flight.fly()
    for _ in range(50):
        flight.tick()
    flight.tick(AskedBy(arm=False))
    while flight.stage is not SafetyStage.DISARMED:
        flight.tick()
    handed = flight.kept.options_of('hand_over')
    assert handed
    assert all(one == {'land': rises} for one in handed)


@pytest.mark.parametrize('bad', [math.nan, math.inf])
@pytest.mark.parametrize('command', ['motors', 'setpoint'])
def test_what_is_no_number_is_no_command(command, bad):
    flight = Bridged(command)
    flight.asked = CrazyflieCommand(0, duties=(0.1,) * 4, height=1.0)
    flight.fly()
    before = flight.bridge.unasked.count
    if command == 'motors':
        flight.asked = flight.asked._replace(duties=(0.1, 0.1, bad, 0.1))
    else:
        flight.asked = flight.asked._replace(height=bad)
    for _ in range(17):
        flight.tick()
    assert flight.bridge.unasked.count == before + 17
    assert flight.stage is SafetyStage.LANDING


def test_where_graph_time_stands_still_nothing_is_fresh():
    """The clock of a simulation that stopped: the last command would be flown for ever."""
    flight = Bridged().fly()
    for turn in range(20):
        flight.bridge.tick(1e-9 * flight.now + 0.02 * turn, flight.now, True, True, NOTHING)
        assert flight.stage is (SafetyStage.LANDING if turn * 0.02 > 0.3 else SafetyStage.FLYING)


@settings(max_examples=25)
@given(
    st.lists(
        st.tuples(st.sampled_from(['new', 'repeats', 'unknown', 'none']), st.integers(5, 140)),
        min_size=1,
        max_size=6,
    )
)
def test_no_flight_goes_on_without_a_height(parts):
    """No drone flies 2 s after the last new height, whatever else the estimate says."""
    flight = Bridged('motors').fly()
    flight.turning, known = (0.1,) * 4, flight.now
    for what, ticks in parts:
        flight.noise = 1e-6 if what == 'new' else 0.0
        flight.height = 1.0 if what in ('new', 'repeats') else math.nan
        for _ in range(ticks):
            if what == 'unknown':
                flight.bridge.update_position(PositionEstimate(math.nan, 1.0, flight.now + TICK))
            flight.tick()
            known = flight.now if what == 'new' else known
            if flight.stage is SafetyStage.FLYING:
                assert 1e-9 * (flight.now - known) <= STUCK + 2e-9 * TICK


def test_unknown_nodes_that_command_it_neither_arm_nor_fly_it():
    flight = Bridged()
    flight.bridge.rivals = 'unknown nodes'
    flight.tick()
    refusal = flight.bridge.find_arming_refusal(flight.now, True, True)
    assert refusal == ('unknown nodes: stop them, or allow them with allow_other_commanders:=true')
    flight.bridge.rivals = ''
    flight.fly()
    flight.bridge.rivals = 'unknown nodes'
    flight.tick()
    assert (flight.stage, flight.bridge.state.why) == ('landing', 'unknown nodes')


def ticks_fed(flight, count):
    """Return at which of so many ticks the watchdog was fed."""
    fed = []
    for turn in range(count):
        before = len(flight.kept.of('feed_watchdog'))
        flight.tick()
        fed += [turn] * (len(flight.kept.of('feed_watchdog')) - before)
    return fed


def test_the_watchdog_is_fed_from_the_first_arming_on_until_a_stop():
    """One second without a word cuts the motors and locks (supervisor.c)."""
    flight = Bridged(watchdog=True)
    assert ticks_fed(flight, 50) == []  # the first word would start it
    flight.fly()
    fed = ticks_fed(flight, 100)
    gaps = {after - before for before, after in pairwise(fed)}
    assert gaps == {7}  # 0.14 s
    flight.tick(AskedBy(arm=False))
    assert len(ticks_fed(flight, 100)) >= 14  # it landed, and nothing but a restart ends it
    assert flight.stage is SafetyStage.DISARMED
    flight.tick(AskedBy(stop=True))
    assert ticks_fed(flight, 100) == []


def test_no_watchdog_is_started_that_nobody_asked_for():
    assert ticks_fed(Bridged().fly(), 100) == []


ARMED = SafetyInputs(True, True, 2, 0.0, 0.0, 4.0, 1.0, 1.0, 0.0)


def fact(task, bridge, why='', attempts=1, **changed):
    """Return a diagnostic of a bridge in normal operation, with these fields changed."""
    told = describe_health(bridge, why, attempts, 12, ARMED._replace(**changed))
    return {one.task: one for one in told}[task]


def test_what_is_said_of_the_link():
    """Half a second without a packet is silence; without a link the message gives the reason."""
    bridge = BridgeCore(None, load_crazyflie('gtmab'), load_vehicle('gtmab'))
    for silence, said in (
        (0.499, (HealthLevel.OK, 'connected')),
        (0.5, (HealthLevel.ERROR, 'no packets for 0.5 s')),
    ):
        told = fact('link', bridge, silence=silence)
        assert (told.level, told.message) == said
    gone = fact('link', bridge, 'nobody answers', 7, linked=False)
    assert (gone.level, gone.message) == (HealthLevel.ERROR, 'nobody answers')
    assert fact('link', bridge, 'connecting', 0, linked=False).level == HealthLevel.WARN
    bridge.add_round_trip(0.004)
    values = fact('link', bridge, attempts=7, silence=0.25).values
    assert values == {
        'protocol': '12', 'silence_s': '0.250', 'latency_s': '0.0040', 'one_way_s': '0.0020',
        'drift_ppm': '-0.0', 'clock_restarts': '0', 'packets': '0', 'attempts': '7',
    }  # fmt: skip


def test_what_is_said_of_the_motors():
    bridge = BridgeCore(None, load_crazyflie('gtmab'), load_vehicle('gtmab'))
    told = fact('safety', bridge)
    assert (told.level, told.message) == (HealthLevel.OK, 'disarmed: not armed yet')
    assert told.values == {'word': '2', 'command': 'motors', 'voltage': '4.00', 'motors': ''}
    bridge.motors = readings.MotorsReading((0.5, 0.25, 0.0, 1.0), 2)
    bridge.state = SafetyState(SafetyStage.FLYING, why='')
    told = fact('safety', bridge)
    assert (told.level, told.message) == (HealthLevel.OK, 'flying')
    assert told.values['motors'] == '0.50 0.25 0.00 1.00'
    for why, level in (
        ('the battery has only 3.10 V', HealthLevel.WARN),
        ('on request', HealthLevel.OK),
        ('deactivated', HealthLevel.OK),
    ):
        bridge.state = SafetyState(SafetyStage.LANDING, why=why)
        told = fact('safety', bridge)
        assert (told.level, told.message) == (level, f'landing: {why}')
    bridge.state = SafetyState(SafetyStage.DISARMED, why='it has tipped over')
    for bit in (SupervisorBit.TUMBLED, SupervisorBit.LOCKED, SupervisorBit.CRASHED):
        assert fact('safety', bridge, word=int(bit)).level == HealthLevel.ERROR
    bridge.state = SafetyState(SafetyStage.STOPPED, why='emergency stop')
    told = fact('safety', bridge)
    assert (told.level, told.message) == (HealthLevel.ERROR, 'stopped: emergency stop')


GTMAB = CrazyfliePowerModel.from_energy(load_vehicle('gtmab').file.energy)


def test_four_motors_take_what_the_bench_measured():
    """Row by row within 0.3 A: what the energy monitor is told to expect of the model."""
    idle = BENCH[0].current
    for row in BENCH[1:]:
        rotors = (
            -GTMAB.cell_current((row.duty,) * 4, row.voltage) - GTMAB.electronics / row.voltage
        )
        assert rotors == pytest.approx(row.current - idle, abs=0.3)


def test_each_load_counts_once_and_one_that_is_not_told_takes_nothing():
    energy = load_vehicle('gtmab').file.energy
    dark = energy.model_copy(update={'loads': energy.loads.model_copy(update={'sensing': None})})
    assert CrazyfliePowerModel.from_energy(dark).electronics == pytest.approx(0.097 + 0.023)
    # 2 W, and two rotors of 1 W and 10 W/N: at 4 V a duty of 0.25 is 1 V, 25.3 mN.
    told = CrazyfliePowerModel(2.0, 1.0, 10.0).cell_current((0.25, 0.0, 0.25), 4.0)
    assert told == pytest.approx(-(2.0 + 2 * 1.2530) / 4.0, rel=1e-4)
