"""A balloon that is lighter than air is not called landed, and one that coasts is not blamed."""

import math

from lta_bridge.crazyflie.buoyancy import BuoyancyMonitor
from lta_bridge.crazyflie.health_diagnostics import describe_health
from lta_bridge.crazyflie.safety import SafetyRequest
from lta_graph.health import HealthLevel
import pytest

from .bridged import Bridged, NOTHING

MASS, DRAG, DT = 0.7, 0.36, 0.02  # kg with added mass, N s2/m2, s: about those of GT-MAB


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
    seen = flight.bridge.collect_safety_inputs(flight.now, True, True)
    facts = {one.task: one for one in describe_health(flight.bridge, '', 0, 12, seen)}
    assert facts['safety'].level is HealthLevel.ERROR
    assert 'lighter than air and will not land' in facts['safety'].message
