"""The stop of laws that are not the cascade, by estimate and by tracker."""

import math

from lta_control.cascade import Setpoint
from lta_control.estimator import EstimatorSettings
from lta_control.gains_file import load_gains_of
from lta_control.laws import law
from lta_control.laws.frames import from_angles
from lta_control.pilot import Pilot
from lta_sim.vehicle import load_vehicle
import pytest

pytestmark = pytest.mark.usefixtures('plain_laws')
FORCE, DT = (0.0, 0.0, 9.80665), 0.01  # what an accelerometer at rest feels; s
UP = Setpoint(1.2, 0.0, 0.0)


def piloted(name):
    """Return a pilot of the vehicle's own law, at rest until its estimate is ready."""
    vehicle = load_vehicle(name)
    made = law(vehicle.file.control.law)
    gains = load_gains_of(made.gains, vehicle.file.control.gains)
    pilot = Pilot(made, gains, vehicle, EstimatorSettings(rest_time=0.1), DT)
    pilot.guide(UP)
    for _ in range(20):
        pilot.step((0.0, 0.0, 0.0), FORCE, 0.6, 101_000.0)
    return pilot


@pytest.fixture(scope='module', params=['multirotor', 'sblimp'])
def tracked(request, plain_laws):
    """Return functions that fly by a tracker: at a roll, and from the beginning."""
    pilot = piloted(request.param)

    def step(roll, height=0.6):
        pilot.see((0.0, 0.0, height, *from_angles(roll, 0.0, 0.0), *(0.0,) * 6))
        return pilot.step((0.0, 0.0, 0.0), FORCE, height, 101_000.0)

    def begin():
        pilot.stopped = False
        pilot.guide(UP)
        assert any(step(0.0))
        return pilot

    return step, begin


def test_turned_over_the_motors_stay_off(tracked):
    step, begin = tracked
    pilot = begin()
    assert any(step(0.98))
    assert not pilot.stopped
    assert not any(step(1.02))
    assert pilot.stopped
    assert not any(duty for _ in range(5) for duty in step(0.0))


def test_a_tracker_or_a_setpoint_that_is_no_number_stops_the_motors_for_good(tracked):
    step, begin = tracked
    pilot = begin()
    assert not any(step(0.0, math.nan))
    assert pilot.stopped
    assert not any(step(0.0))
    pilot = begin()
    pilot.guide(UP._replace(altitude=math.inf))
    assert not any(step(0.0))
    pilot.guide(UP)
    assert not any(step(0.0))


def test_turned_over_by_its_own_estimate_it_stops_too():
    """BEAVIS has no tracker: its gyroscope tells of 2 rad/s, and half a second is 1 rad."""
    pilot = piloted('beavis')
    assert any(pilot.duties)
    rolling, turns = 0.0, 0
    while not pilot.stopped:
        duties = pilot.step((2.0, 0.0, 0.0), FORCE, 0.6, 101_000.0)
        rolling += 2.0 * DT
        turns += 1
        assert turns < 100
    assert rolling == pytest.approx(1.0, abs=0.1)  # gravity draws the estimate back a little
    assert not any(duties)
    for _ in range(300):
        assert not any(pilot.step((0.0, 0.0, 0.0), FORCE, 0.6, 101_000.0))
