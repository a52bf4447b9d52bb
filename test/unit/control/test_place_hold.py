# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Places that are held and flown to, also in a wind."""

import math

from lta_control.odometry.tracked_motion import LocatedMotion
from lta_control.place_hold import (
    begin_hold,
    find_route_fault,
    Place,
    PlaceHold,
    REST_DISTANCE,
    Route,
    steer_to_place,
)
from lta_control.strategies.homing import solve_wind_triangle
from lta_control.strategies.settings import StrategySettings
import pytest

SETTINGS = StrategySettings()  # 0.12 m/s2, 0.48 rad/s, 5 m of coasting
STILL = LocatedMotion((0.0, 0.0), (0.0, 0.0), (0.0, 0.0), 0.0, 0.0, True)


def steer(motion, goal, hold=None):
    return steer_to_place(SETTINGS, hold or begin_hold(motion, goal), motion)


def test_it_turns_to_the_place_and_flies_no_faster_than_it_can_stop():
    """From 1 m: T = pi / 0.48 = 6.545 s, v = 0.12 (sqrt(T^2 + 2 / 0.12) - T) = 0.1403 m/s."""
    speed, hold = steer(STILL, (1.0, 0.0))
    assert hold.heading == pytest.approx(0.0)
    assert speed == pytest.approx(0.1403, abs=1e-4)
    speed, hold = steer(STILL, (100.0, 0.0))
    assert speed == pytest.approx(0.3)


def test_against_a_wind_it_stands_with_its_nose_into_it():
    wind = STILL._replace(wind=(0.0, -0.3), heading=0.5 * math.pi)
    speed, hold = steer(wind, (0.0, 0.0))
    assert hold.heading == pytest.approx(0.5 * math.pi)
    assert speed == pytest.approx(0.3)


def test_it_turns_against_a_motion_that_is_too_fast():
    """At the place at 0.3 m/s in still air, only the change of velocity takes a force."""
    fast = STILL._replace(velocity=(0.3, 0.0), heading=0.8 * math.pi)
    speed, hold = steer(fast, (0.0, 0.0), PlaceHold((0.0, 0.0), True, math.pi))
    assert abs(hold.heading) == pytest.approx(0.8 * math.pi + 0.5)  # slowly, in calm air
    assert speed == pytest.approx(0.0, abs=1e-6)


def test_in_calm_air_it_rests_until_it_has_drifted_away():
    near = STILL._replace(position=(0.9 * REST_DISTANCE, 0.0), heading=1.0)
    speed, hold = steer(near, (0.0, 0.0))
    assert (speed, hold.heading, hold.resting) == (0.0, 1.0, True)
    # It keeps the heading that it had, and the place
    drifted = near._replace(position=(1.9 * REST_DISTANCE, 0.0), heading=1.1)
    assert steer(drifted, hold.goal, hold) == (0.0, hold)
    gone = near._replace(position=(2.1 * REST_DISTANCE, 0.0))
    speed, hold = steer(gone, hold.goal, hold)
    assert speed > 0.0
    assert not hold.resting


ROOM = (10.0, 8.0, 3.0)


OUTSIDE = 'm lies outside the room, 10 m x 8 m around the origin'
HEIGHTS = 'm above the ground; give more than 0.47, at most 3, or 0 for its present height'


@pytest.mark.parametrize(
    ('place', 'why'),
    [
        ((math.nan, 0.0, 1.0), 'the place nan, 0, 1 m is not finite'),
        ((0.0, math.inf, 1.0), 'the place 0, inf, 1 m is not finite'),
        ((5.1, 0.0, 1.0), f'the place 5.1, 0 {OUTSIDE}'),
        ((0.0, -4.1, 1.0), f'the place 0, -4.1 {OUTSIDE}'),
        ((0.0, 0.0, 3.5), f'the hull centre cannot fly 3.5 {HEIGHTS}'),
        ((0.0, 0.0, 0.4), f'the hull centre cannot fly 0.4 {HEIGHTS}'),
    ],
)
def test_a_place_that_cannot_be_flown_to_is_refused(place, why):
    good = Place(5.0, -4.0, 0.0)
    assert find_route_fault(Route((good,)), ROOM, 0.47, 100.0) == ''
    assert find_route_fault(Route((good, Place(*place))), ROOM, 0.47, 100.0) == why


def test_a_route_without_places_or_with_a_tolerance_that_is_none_is_refused():
    assert find_route_fault(Route(), ROOM, 0.47, 100.0) == 'there is no place to fly to'
    nan = Route((Place(0.0, 0.0, 1.0),), math.nan)
    assert 'a tolerance of nan m cannot be flown' in find_route_fault(nan, None, 0.47, 100.0)
    far = Route((Place(500.0, 0.0, 50.0),))
    assert find_route_fault(far, None, 0.47, 100.0) == ''


EAST = (7.0, 0.0)


def flown(line, wind, over_ground=0.5, top=1.0, least=0.0):
    return solve_wind_triangle(line, wind, over_ground, top, least)


def test_in_still_air_it_flies_along_the_line():
    assert flown((3.0, 3.0), (0.0, 0.0)) == (pytest.approx(math.pi / 4), pytest.approx(0.5))


def test_a_head_wind_is_flown_against_as_fast_as_it_can():
    assert flown(EAST, (-0.3, 0.0)) == (pytest.approx(0.0), pytest.approx(0.8))
    assert flown(EAST, (-0.9, 0.0)) == (pytest.approx(0.0), pytest.approx(1.0))


def test_what_is_across_is_held_before_what_is_along():
    heading, speed = flown(EAST, (-0.9, 0.6))
    assert speed == pytest.approx(1.0)
    assert math.sin(heading) == pytest.approx(-0.6)


def test_without_speed_it_looks_along_the_line():
    assert flown((0.0, 2.0), (0.0, 0.5)) == (pytest.approx(math.pi / 2), 0.0)


def test_a_wind_that_is_too_strong_leaves_some_way_along():
    heading, speed = flown(EAST, (0.0, 3.0))
    assert speed == pytest.approx(1.0)
    assert -math.pi / 2 < heading < -1.0


@pytest.mark.parametrize('side', [1.0, -1.0])
def test_at_most_95_per_cent_of_the_airspeed_is_directed_across_the_line(side):
    """The cross wind is stronger than the airspeed; sqrt(1 - 0.95^2) is left along the line."""
    heading, speed = flown(EAST, (0.0, 3.0 * side), over_ground=9.0, top=2.0)
    left = math.sqrt(1.0 - 0.95**2)
    assert (heading, speed) == (pytest.approx(-side * math.atan2(0.95, left)), pytest.approx(2.0))


@pytest.mark.parametrize(('speed', 'flies'), [(0.1, True), (0.0999, False)])
def test_an_airspeed_below_10_cm_a_second_is_not_flown(speed, flies):
    """In a cross wind alone it faces the wind, or along the line if the wind is weaker."""
    heading, asked = flown(EAST, (0.0, speed), over_ground=0.0)
    assert (heading, asked) == ((-math.pi / 2, speed) if flies else (0.0, 0.0))
