# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The stop of laws that are not the cascade, by estimate and by tracker."""

import math

from lta_control.autopilot import Autopilot, build_drone_constants
from lta_control.estimator import EstimatorSettings
from lta_control.laws import find_control_law, load_law_gains
from lta_control.motion import DeadReckonedMotion, quaternion_from_angles, Setpoint
from lta_model.vehicle import load_vehicle
import pytest

pytestmark = pytest.mark.usefixtures('plain_laws')
FORCE, DT = (0.0, 0.0, 9.80665), 0.01  # what an accelerometer at rest feels; s
UP = Setpoint(1.2, 0.0, 0.0)


def piloted(name):
    """Return a pilot of the vehicle's own law, at rest until its estimate is ready."""
    vehicle = load_vehicle(name)
    made = find_control_law(vehicle.file.control.law)
    gains = load_law_gains(made.gains, vehicle.file.control.gains)
    drone = build_drone_constants(vehicle, EstimatorSettings(rest_time=0.1), gains, DT, law=made)
    pilot = Autopilot(drone, made)
    pilot.set_setpoint(UP)
    for _ in range(20):
        pilot.step((0.0, 0.0, 0.0), FORCE, 0.6, 101_000.0)
    return pilot


@pytest.fixture(scope='module', params=['multirotor', 'sblimp'])
def tracked(request, plain_laws):
    """Return functions that fly by a tracker: at a roll, and from the beginning."""
    pilot = None

    def step(roll, height=0.6):
        pilot.receive_tracking(
            (0.0, 0.0, height, *quaternion_from_angles(roll, 0.0, 0.0), *(0.0,) * 6)
        )
        return pilot.step((0.0, 0.0, 0.0), FORCE, height, 101_000.0)

    def begin():
        nonlocal pilot
        pilot = piloted(request.param)
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
    pilot.set_setpoint(UP._replace(altitude=math.inf))
    assert not any(step(0.0))
    pilot.set_setpoint(UP)
    assert not any(step(0.0))


def test_a_tracker_that_repeats_its_height_stops_the_motors_for_good(tracked):
    step, begin = tracked
    pilot = begin()
    assert all(any(step(0.0, 0.6)) for _ in range(190))
    assert not any([any(step(0.0, 0.6)) for _ in range(30)][-10:])
    assert pilot.stopped


@pytest.fixture(scope='module')
def beavis(plain_laws):
    """Return a pilot without a tracker whose estimate has moved and turned for 0.1 s."""
    pilot = piloted('beavis')
    for _ in range(10):
        pilot.step((0.0, 0.0, 0.5), (0.3, -0.2, 9.80665), 0.6, 101_000.0)
    return pilot


def test_reckoned_and_measured_values_are_those_of_the_estimate(beavis):
    own = beavis.estimate
    assert min(map(abs, (*own.position, own.airspeed.surge, own.airspeed.sway))) > 0.0
    yaw = 2.0 * math.atan2(own.attitude[2], own.attitude[3])
    assert yaw == pytest.approx(0.05, rel=1e-2)  # 0.1 s at 0.5 rad/s
    found = beavis.dead_reckoning
    assert found.heading == pytest.approx(yaw, abs=1e-5)
    assert found == DeadReckonedMotion(
        beavis.heading, *own.position, own.airspeed.surge, own.airspeed.sway
    )
    told = beavis.measurement
    assert (told.altitude, told.heading) == (own.altitude.height, beavis.heading)
    assert told.climb == pytest.approx(own.altitude.climb, abs=1e-12)
    assert told[3:] == (own.rates[2], own.airspeed.surge, own.airspeed.sway, own.rates[1])


def test_it_does_not_move_before_a_setpoint_and_a_tracked_pose_have_come():
    """RGBlimp's motors stay off, and its moving mass stays where the vehicle file puts it."""
    vehicle = load_vehicle('rgblimp')
    made = find_control_law('glide')
    gains = load_law_gains(made.gains, 'rgblimp')
    drone = build_drone_constants(vehicle, EstimatorSettings(rest_time=0.1), gains, DT, law=made)
    place = vehicle.file.moving_mass.position.vector
    pilot, rest = Autopilot(drone, made, place), ((0.0, 0.0), place)
    truth = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, *(0.0,) * 6)

    def command():
        return pilot.step((0.0, 0.0, 0.0), FORCE, 0.6, 101_000.0), pilot.mass_place

    assert [command() for _ in range(12)] == [rest] * 12
    assert pilot.measurement is None
    pilot.set_setpoint(Setpoint(1.2, 0.3, 0.5))
    assert command() == rest
    pilot.receive_tracking((*truth, 9.0))  # numbers after the rates are ignored
    assert command() != rest
    assert pilot.measurement.altitude == 1.0
    pilot.set_setpoint(Setpoint(0.0, 0.0, 0.0))
    pilot.receive_tracking((0.0, 0.0, vehicle.hull_height_on_floor, *truth[3:]))
    assert command() == rest  # landed
