"""A balloon that is lighter than air is not called landed, and one that coasts is not blamed."""

import math

from lta_bridge.crazyflie.buoyancy import BuoyancyMonitor
from lta_bridge.crazyflie.duties_packet import unpack_duties
from lta_bridge.crazyflie.health_diagnostics import describe_health
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
    flight = Bridged('motors', pressing=('forward_left',))
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
