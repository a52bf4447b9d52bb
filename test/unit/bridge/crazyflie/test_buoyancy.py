# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A balloon that is lighter than air is not called landed, and one that coasts is not blamed."""

import math

from lta_bridge.crazyflie.bridge_core import PositionEstimate
from lta_bridge.crazyflie.buoyancy import BuoyancyMonitor
from lta_bridge.crazyflie.drone_operation import describe_health
from lta_bridge.crazyflie.duties_packet import unpack_duties
from lta_bridge.crazyflie.safety import SafetyRequest
from lta_graph.health import HealthLevel
import pytest

from .bridged import Bridged, NOTHING

MASS, DRAG, DT = 0.7, 0.36, 0.02  # kg with added mass, N s2/m2, s: about those of GT-MAB


def describe_safety(flight):
    """Return what /diagnostics says of the safety of a flight."""
    seen = flight.bridge.collect_safety_inputs(flight.now, True, True)
    facts = {one.task: one for one in describe_health(flight.bridge, '', 0, 12, seen)}
    return facts['safety']


def watch(net_lift, pressing, thrust, seconds=8.0, climb=0.0):
    """Return the monitor of a balloon [N] that a rotor pushes down [N] with a duty."""
    monitor, z = BuoyancyMonitor(), 1.0
    for turn in range(round(seconds / DT)):
        climb += DT * (net_lift - thrust - DRAG * climb * abs(climb)) / MASS
        z += DT * climb
        monitor.observe(turn * DT, z, 0.0, pressing)
    return monitor


def rises(net_lift, climb, seconds=8.0, duty=0.0, height=lambda z: z):
    """Return what is said of a balloon [N] that climbs at first [m/s]."""
    monitor, z = BuoyancyMonitor(), 1.0
    for turn in range(round(seconds / DT)):
        climb += DT * (net_lift - DRAG * climb * abs(climb)) / MASS
        z += DT * climb
        monitor.observe(turn * DT, height(z), duty)
    return monitor.rises


@pytest.mark.parametrize('net_lift', [0.005, 0.02, 0.1])  # 0.5 g, 2 g and 10 g light
def test_a_light_balloon_is_found(net_lift):
    assert rises(net_lift, 0.0, 15.0)


@pytest.mark.parametrize('climb', [-0.3, 0.0, 0.2, 0.5, 1.0])
def test_a_heavy_balloon_that_coasts_is_not(climb):
    """2 g heavy, as ballasted."""
    assert not rises(-0.02, climb)


def test_thrust_or_no_height_says_nothing():
    assert not rises(0.1, 0.0, duty=0.1)
    assert not rises(0.1, 0.0, duty=math.nan)
    assert not rises(0.1, 0.0, height=lambda _: math.nan)


def test_a_balloon_that_is_held_down_is_found():
    """It neither rises nor sinks, and would rise without the rotor; a heavy one sinks."""
    assert watch(0.05, pressing=0.3, thrust=0.05).is_held_down
    assert not watch(-0.02, pressing=0.3, thrust=0.05).is_held_down
    assert not watch(0.0, pressing=0.0, thrust=0.0).is_held_down


@pytest.mark.parametrize('climb', [0.15, 0.25])
def test_a_heavy_balloon_that_coasts_up_against_its_rotor_is_not_held_down(climb):
    assert not watch(-0.01, pressing=0.04, thrust=0.005, seconds=4.0, climb=climb).is_held_down


def test_a_rotor_that_no_longer_pushes_holds_nothing_down_also_without_a_height():
    monitor = watch(0.05, pressing=0.3, thrust=0.05)
    monitor.observe(8.0, math.nan, 0.0, 0.0)
    assert not monitor.is_held_down


def test_a_rotor_that_holds_down_is_reported_and_stops_with_the_others():
    """Nobody may be hurt by a motor that goes on because a balloon would rise."""
    flight = Bridged('motors', axes={'forward_left': (0.0, 0.0, -1.0)})
    flight.asked = flight.asked._replace(duties=(0.0, 0.0, 0.3, 0.0))
    flight.turning = (0.0, 0.0, 0.3, 0.0)
    flight.fly()
    for _ in range(300):
        flight.tick()
    assert 'hold the tether before you disarm it' in describe_safety(flight).message
    before = len(flight.kept.of('send_duties'))
    flight.tick(SafetyRequest(arm=False))
    for _ in range(40):  # 0.8 s: the ramp of 0.5 s, and the hand-over
        flight.tick()
    sent = [unpack_duties(data).duties for (data,) in flight.kept.of('send_duties')[before:]]
    assert sent[0][2] == pytest.approx(0.3, abs=1e-3)
    assert sent[-1] == (0.0,) * 4
    assert flight.kept.of('hand_over')


@pytest.mark.parametrize(
    ('axis', 'held_down'),
    [((0.6, 0.0, -0.8), True), ((0.94, 0.0, -0.34), True), ((1.0, 0.0, 0.0), False)],
)
def test_a_tilted_rotor_pushes_down_by_its_vertical_share(axis, held_down):
    """0.8 and 0.34 of a duty of 0.1 are above 0.02, and a level rotor does nothing."""
    flight = Bridged('motors', axes={'forward_left': axis})
    flight.turning = (0.0, 0.0, 0.1, 0.0)
    flight.fly()
    for _ in range(300):
        flight.tick()
    assert ('is pushed down' in describe_safety(flight).message) is held_down


@pytest.mark.parametrize(
    ('up', 'rises'), [(0.34, False), (0.0, True)], ids=['20 degrees up', 'level']
)
def test_a_drone_that_rises_by_a_tilted_rotor_is_not_called_light(up, rises):
    flight = Bridged('motors', axes={'forward_left': (math.sqrt(1.0 - up * up), 0.0, up)})
    flight.turning = (0.0, 0.0, 0.1, 0.0)
    flight.fly()
    for _ in range(300):
        flight.height += 0.1 * DT
        flight.tick()
    assert ('rises without thrust' in describe_safety(flight).message) is rises


@pytest.mark.parametrize(('duty', 'says'), [(0.019, True), (0.021, False)])
def test_a_duty_of_two_hundredths_is_a_rotor_that_lifts(duty, says):
    """The motors of GT-MAB give about 0.1 mN at 0.02, half a percent of its net weight."""
    assert rises(0.1, 0.0, duty=duty) is says
    assert watch(0.05, pressing=duty, thrust=0.05).is_held_down is not says


def land_on_the_floor(flight, seconds, height):
    """Hold a height [m] while the setpoint is on the floor and motors turn."""
    flight.bridge.wanted_height = 0.3
    flight.turning = (0.0, 0.0, 0.3, 0.0)
    flight.height = height
    for _ in range(round(seconds / DT)):
        flight.tick()
    return flight


@pytest.mark.parametrize('command', ['motors', 'setpoint'])
@pytest.mark.parametrize('axis', [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)], ids=['up', 'down'])
@pytest.mark.parametrize('height', [0.6, math.nan])
def test_a_landing_on_a_floor_that_reads_too_high_ends_and_motors_stop(command, axis, height):
    """Whoever commands the motors, and where the height is unknown."""
    flight = Bridged(command, axes={'forward_left': axis}, blind=math.isnan(height))
    flight.height = height
    flight.fly()
    land_on_the_floor(flight, 9.9, height)
    assert flight.stage == 'flying'
    land_on_the_floor(flight, 0.2, height)
    assert (flight.stage, flight.bridge.state.why) == (
        'landing', 'to land, it has not sunk for 10 s: it stands on the ground',
    )  # fmt: skip
    land_on_the_floor(flight, 1.0, height)  # the ramp, and commands that still come
    if command == 'motors':
        (last,) = flight.kept.of('send_duties')[-1]
        assert unpack_duties(last).duties == (0.0,) * 4
    assert flight.kept.of('hand_over')


@pytest.mark.parametrize('command', ['motors', 'setpoint'])
def test_a_stuck_height_ends_a_flight_before_it_counts_as_the_ground(command):
    """To land or not: a height that repeats while motors turn is unknown after 2 s."""
    flight = Bridged(command).fly()
    flight.noise = 0.0
    for _ in range(200):
        flight.tick()  # its motors are still, as those of a drone that coasts
    assert flight.stage == 'flying'
    land_on_the_floor(flight, 1.9, 1.0)
    assert flight.stage == 'flying'
    land_on_the_floor(flight, 0.2, 1.0)
    assert (flight.stage, flight.bridge.state.why) == (
        'landing', 'the position of the drone is not known',
    )  # fmt: skip
    land_on_the_floor(flight, 1.0, 1.0)
    assert flight.kept.of('hand_over')


@pytest.mark.parametrize(
    ('sensor', 'value', 'word'),
    [
        ('baro.pressure', 1000.0, 'the barometer repeats its reading'),
        ('range.zrange', 800.0, 'the range finder repeats its reading'),
        ('range.zrange', 32767.0, ''),  # out of reach of the floor: no reading
    ],
)
def test_by_setpoints_a_sensor_that_repeats_ends_the_flight(sensor, value, word):
    """Our estimator sees no duties there, and the firmware's own does not look."""
    flight = Bridged('setpoint').fly()
    flight.air[sensor] = (value, 0.0)
    for _ in range(200):
        flight.tick()  # its motors are still
    assert flight.stage == 'flying'
    flight.turning = (0.3,) * 4
    for _ in range(95):  # 1.9 s
        flight.tick()
    assert flight.stage == 'flying'
    for _ in range(10):
        flight.tick()
    assert flight.stage == ('landing' if word else 'flying')
    assert word in describe_safety(flight).message
    refusal = flight.bridge.find_arming_refusal(flight.now, True, True)
    assert ('position of the drone is not known' in refusal) == bool(word)


def test_by_duties_our_estimator_judges_the_sensors():
    """It flies on by the barometer, and says that the height is unknown without both."""
    flight = Bridged('motors').fly()
    flight.air['range.zrange'] = (800.0, 0.0)
    flight.turning = (0.3,) * 4
    for _ in range(300):
        flight.tick()
    assert flight.stage == 'flying'


def test_a_tracker_replaces_a_stuck_estimate():
    flight = Bridged('motors').fly()
    flight.noise = 0.0
    flight.turning = (0.0, 0.0, 0.3, 0.0)
    for turn in range(300):
        flight.bridge.update_tracked_position(PositionEstimate(0.9 + 1e-6 * turn, 2.0, flight.now))
        flight.tick()
    assert flight.stage == 'flying'
    assert flight.bridge.collect_safety_inputs(flight.now, True, True).distance == 2.0


def test_a_descent_and_a_stand_with_still_motors_go_on():
    flight = Bridged('motors').fly()
    for turn in range(30):
        land_on_the_floor(flight, 1.0, 3.0 - 0.05 * turn)  # 5 cm/s
    assert flight.stage == 'flying'
    flight.turning = (0.0,) * 4
    for _ in range(1000):
        flight.tick()
    assert flight.stage == 'flying'
    flight.bridge.wanted_height = 1.0  # up again, and at one height
    flight.turning = (0.3,) * 4
    for _ in range(1000):
        flight.tick()
    assert flight.stage == 'flying'


def test_a_landing_of_a_light_balloon_is_reported_as_an_error():
    """Its motors stop, it is disarmed, and still it rises."""
    flight = Bridged('motors').fly()
    z = [1.0]

    def tick(asked=NOTHING):
        z[0] += 0.1 * DT
        flight.height = z[0]
        flight.tick(asked)

    tick(SafetyRequest(arm=False))
    for _ in range(400):
        tick()
    assert flight.stage == 'disarmed'
    fact = describe_safety(flight)
    assert fact.level is HealthLevel.ERROR
    assert 'lighter than air and will not land' in fact.message
