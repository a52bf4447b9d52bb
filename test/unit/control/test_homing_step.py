# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Single steps of homing, by hand: which sights fit, dead reckoning, loss of light, course."""

import math

from lta_control.strategies.homing import (
    brake_ahead,
    build_filter_prior,
    coasting_distance,
    full_turn_time,
    HomingState,
    must_brake,
    reset_for_next_lamp,
    start,
    steer,
    steer_search,
    steer_to_lamp,
    stopping_speed,
    update_with_sight,
    watch,
)
from lta_control.strategies.lamp_ekf import (
    expected_strength,
    LampFix,
    normalized_innovation,
    predict_fix,
)
from lta_control.strategies.protocol import LightMeasurement
from lta_control.strategies.settings import HomingSettings, StrategySettings
import pytest

QUICK = StrategySettings(homing=HomingSettings(hold=0.5, doubt=0.5, settling=5.0, brake=False))
# Half a turn takes 4 s
OWN = HomingSettings(deceleration=0.1, turn_rate=0.25 * math.pi, coasting=5.0)
BRAKING = StrategySettings(homing=OWN)
QUARTER = 0.25  # s; a power of two, so that sums of intervals are exact


def placed(x=4.0, y=0.0, wind=(0.0, 0.0), **changes):
    """Return a memory with the lamp at (x, y) and a deviation of 10 cm or 10 cm/s."""
    rows = tuple(tuple(0.01 * (k == j) for j in range(5)) for k in range(5))
    fix = LampFix(x, y, *wind, math.log(2000.0), rows)
    memory = start(0.3)._replace(has_fix=True, fix=fix, begun=True)
    return memory._replace(**changes)


def dark():
    return LightMeasurement(False, 0.0, 0.0, (0.0,), QUARTER)


def lit(memory, share=1.0, off=0.0):
    """Return a sight of `share` times the expected strength, `off` beside the expected bearing."""
    bearing = math.atan2(memory.fix.y, memory.fix.x) + off
    strength = share * expected_strength(memory.fix)
    return dark()._replace(seen=True, bearing=bearing, deviation=0.02, strength=strength)


def test_the_drift_noise_is_larger_until_the_airspeed_has_settled():
    """hypot(0.3, 0.4) = 0.5 at first; after `settling` the second part has fallen to 1 / e."""
    own = HomingSettings(gusts=0.3, unsettled=0.4, settling=5.0)
    first = (math.log(2100.0), 0.5, 0.03, 0.15, 0.4, pytest.approx(0.5), 0.8)
    assert build_filter_prior(own, 0.0) == first
    assert build_filter_prior(own, 5.0).gusts == pytest.approx(math.hypot(0.3, 0.4 / math.e))


def test_for_the_next_lamp_only_the_wind_the_place_and_the_flight_time_are_kept():
    memory = HomingState(
        0.1, True, placed().fix, True, (1.0, 2.0), 7.0, 3.0, 900.0, 1.0, 2.0, True, True
    )
    assert reset_for_next_lamp(memory) == memory._replace(
        has_fix=False, lost=0.0, brightest=0.0, doubted=0.0, searched=0.0, arrived=False,
        braking=False,
    )  # fmt: skip
    assert not reset_for_next_lamp(memory._replace(begun=False)).begun


@pytest.mark.parametrize('factor', [1.0, 1.0 + 1e-12])
def test_a_bearing_is_used_up_to_the_trusted_deviation(factor):
    seen = lit(placed())._replace(deviation=factor * QUICK.homing.trusted)
    assert watch(QUICK, start(0.0), seen).has_fix is (factor == 1.0)


def test_a_strength_below_one_count_is_taken_as_one_count():
    """By the inverse square law 2100 counts at 1 m fall to 1 count at sqrt(2100) m."""
    memory = watch(QUICK, start(0.0), lit(placed())._replace(strength=0.5))
    assert memory.fix.x == pytest.approx(math.sqrt(2100.0))


@pytest.mark.parametrize(
    ('share', 'lost', 'doubted'),
    [
        (0.2499, 0.5, 0.0),  # too weak: an echo, which raises no doubt
        (0.25, 0.0, 0.0),
        (4.0, 0.0, 0.0),
        (4.001, 0.5, 0.5),  # too strong: perhaps the lamp is elsewhere
    ],
)
def test_a_light_fits_from_a_quarter_to_four_times_the_expected_strength(share, lost, doubted):
    memory = placed(lost=0.25, doubted=0.25)
    after = update_with_sight(QUICK, memory, lit(memory, share))
    assert (after.lost, after.doubted, after.has_fix) == (lost, doubted, True)
    assert (after.fix.brightness == memory.fix.brightness) is (lost > 0.0)


@pytest.mark.parametrize(('sigmas', 'fits'), [(3.99, True), (4.01, False)])
def test_a_bearing_fits_within_four_deviations(sigmas, fits):
    memory = placed()
    ahead = predict_fix(build_filter_prior(QUICK.homing, 0.0), memory.fix, 0.0, 0.0, QUARTER)
    one = 0.1 / normalized_innovation(ahead, build_filter_prior(QUICK.homing, 0.0), 0.1, 0.02)
    assert (update_with_sight(QUICK, memory, lit(memory, 1.0, sigmas * one)).lost == 0.0) is fits


def test_dead_reckoning_moves_the_lamp_relative_to_the_drone():
    """The drone flies by (0.5, -0.25) m while the air carries it by 0.4 m/s * 0.25 s along y."""
    memory = placed(wind=(0.0, 0.4), place=(1.0, 2.0), flight_time=3.0)
    after = update_with_sight(QUICK, memory, dark()._replace(position=(1.5, 1.75)))
    assert (after.fix.x, after.fix.y) == pytest.approx((3.5, 0.25 - 0.1))
    assert (after.place, after.flight_time, after.begun) == ((1.5, 1.75), 3.25, True)


@pytest.mark.parametrize(
    ('away', 'before', 'arrived'),
    [(0.8, False, True), (0.801, False, False), (1.6, True, True), (1.601, True, False)],
)
def test_it_arrives_within_80_cm_and_remains_arrived_within_twice_that(away, before, arrived):
    assert update_with_sight(QUICK, placed(away, arrived=before), dark()).arrived is arrived
    unknown = placed(away, arrived=before, has_fix=False)
    assert not update_with_sight(QUICK, unknown, dark()).arrived


def test_without_light_it_keeps_its_course_and_then_searches():
    """The hold time is 0.5 s, which the third interval without light exceeds."""
    memory, courses = placed(0.5, arrived=True), []
    for _ in range(3):
        course, memory = steer(QUICK, memory, dark())
        courses.append((course.arrived, memory.lost, memory.searched, memory.arrived))
    assert courses == [(True, 0.25, 0.0, True), (True, 0.5, 0.0, True), (False, 0.75, 0.25, False)]
    assert course.heading == pytest.approx(math.atan2(0.0, 0.5) + 0.3 * QUARTER)
    _, memory = steer(QUICK, memory._replace(lost=0.0), dark())
    assert memory.searched == 0.5  # a search goes on until light is seen
    course, memory = steer(QUICK, memory, lit(memory))
    assert (memory.lost, memory.searched, course.arrived) == (0.0, 0.0, True)


@pytest.mark.parametrize(
    ('x', 'wind', 'speed', 'course'),
    [
        (4.0, 0.0, 0.5, (0.0, 0.5)),
        (1.0, 0.0, 0.5, (0.0, 0.3)),  # near the lamp 0.5 m/s per metre beyond 0.4 m
        (0.4, 0.0, 0.5, (0.0, 0.0)),
        (0.0, 0.0, 0.5, (0.0, 0.0)),
        (1.0, 0.5, 0.5, (0.0, 0.1)),  # the wind carries it: the least airspeed forward
        (0.9, 0.5, 0.5, (math.pi, 0.25)),  # near the lamp it brakes against the wind
        (0.5, 2.0, 0.5, (math.pi, 0.7)),
        (9.0, 0.0, 1.2, (0.0, 1.2)),  # the cruise speed may exceed the top speed
    ],
)
def test_heading_and_airspeed_along_the_line_to_the_lamp(x, wind, speed, course):
    settings = StrategySettings(speed=speed, homing=HomingSettings(brake=False))
    heading, airspeed = steer_to_lamp(settings, placed(x, wind=(wind, 0.0)), dark())
    assert (abs(heading), airspeed) == pytest.approx(course, abs=1e-6)


def test_the_speed_that_stops_within_a_distance():
    """Of 3.25 m, 2 m pass at 0.5 m/s in the turn of 4 s, and 0.5^2 / 0.2 = 1.25 m after it."""
    assert stopping_speed(OWN, 3.25, math.pi) == pytest.approx(0.5)
    assert stopping_speed(OWN, 1.25, 0.0) == pytest.approx(0.5)
    assert stopping_speed(OWN, 0.0, math.pi) == 0.0


def test_drag_alone_stops_a_drone_against_a_wind_only():
    """From 0.6 to 0.3 m/s in air: 5 ln 2, less the wind's way in 5 (1 / 0.3 - 1 / 0.6) s."""
    assert coasting_distance(OWN, 0.3, 0.3) == pytest.approx(5.0 * (math.log(2.0) - 0.5))
    assert coasting_distance(OWN, 0.3, 0.0) == math.inf


@pytest.mark.parametrize(
    ('x', 'wind', 'drift', 'braking', 'brakes'),
    [
        (3.3, 0.0, (0.5, 0.0), False, False),
        (3.2, 0.0, (0.5, 0.0), False, True),
        (3.2, 0.0, (0.5, 0.0), True, True),
        (1.2, 0.0, (-0.5, 0.0), False, False),  # away from the lamp
        (0.0, 0.0, (0.11, 0.0), False, False),  # so little is not worth a turn
        (0.9, 0.0, (0.11, 0.0), True, True),  # once begun, it lasts to the end
        (0.9, 0.0, (0.09, 0.0), True, False),
        (1.0, -0.3, (0.6, 0.0), False, False),  # drag stops it within 0.97 m
        (0.9, -0.3, (0.6, 0.0), False, True),
    ],
)
def test_it_brakes_where_the_distance_left_is_that_of_turn_and_deceleration(
    x, wind, drift, braking, brakes
):
    memory = placed(x, wind=(wind, 0.0), braking=braking)
    assert must_brake(BRAKING, memory, dark()._replace(drift=drift)) is brakes


@pytest.mark.parametrize(
    ('wind', 'drift', 'course'),
    [
        # It flies at 0.4 m/s to a lamp at 1.25 m, from which 0.5 m/s can stop: no push
        ((0.0, 0.0), (0.4, 0.0), (2.0, -0.5)),
        ((0.2, 0.0), (0.2, 0.0), (2.0, -0.3)),  # the same over ground
        ((0.0, 0.0), (-0.4, 0.0), (0.0, 0.0)),  # away from the lamp: stop
    ],
)
def test_it_turns_against_its_motion_and_pushes_only_where_it_is_too_fast(wind, drift, course):
    memory = placed(1.25, wind=wind)._replace(heading=0.6)
    assert brake_ahead(BRAKING, memory, dark()._replace(drift=drift)) == pytest.approx(course)


def test_a_turn_about_keeps_its_sense():
    memory, fast = placed(2.4), dark()._replace(drift=(0.5, 0.01))
    for heading in (0.6, -0.6):
        turned = brake_ahead(BRAKING, memory._replace(heading=heading), fast)[0]
        assert turned == math.copysign(2.0, heading)


def test_at_the_lamp_it_rests_in_calm_air_and_stands_in_a_wind():
    at = placed(0.0, arrived=True)
    assert steer_to_lamp(BRAKING, at, dark()._replace(heading=1.5)) == (1.5, 0.0)
    windy = placed(0.0, wind=(0.0, 0.3), arrived=True)
    assert steer_to_lamp(BRAKING, windy, dark()) == pytest.approx((-math.pi / 2, 0.3))


def test_near_the_lamp_it_stays_without_light_and_far_from_it_it_searches():
    for x, searches in ((2.9, False), (3.1, True)):
        memory = steer(BRAKING, placed(x, lost=OWN.hold), dark())[1]
        assert (memory.searched > 0.0) is searches


@pytest.mark.parametrize(('settings', 'share', 'lost'), [
    (BRAKING, 0.8, QUARTER), (BRAKING, 0.9, 0.0), (QUICK, 0.8, 0.0),
])  # fmt: skip
def test_light_that_the_hull_begins_to_hide_is_ignored_where_it_brakes(settings, share, lost):
    memory = placed(2.9)
    memory = memory._replace(brightest=expected_strength(memory.fix))
    assert update_with_sight(settings, memory, lit(memory, share)).lost == lost


def test_light_as_strong_as_ever_is_not_hidden_wherever_the_drone_believes_to_be():
    """A lamp that it believes nearer than it is sends less light than expected."""
    memory = placed(2.0)
    sight = lit(memory, 0.7)
    assert update_with_sight(BRAKING, memory._replace(brightest=sight.strength), sight).lost == 0.0


def test_a_search_turns_once_and_then_flies_circles_that_widen_with_time():
    """The turn in 0.1 s is 0.03 rad, and a third of that when three turns' time has passed."""
    turn = full_turn_time(QUICK)
    before, at, later = (
        steer_search(QUICK, placed(searched=time), 0.1) for time in (0.99 * turn, turn, 3.0 * turn)
    )
    assert before == (pytest.approx(0.33), 0.0)
    assert at == (pytest.approx(0.33), QUICK.speed)
    assert later == (pytest.approx(0.31), QUICK.speed)
    assert full_turn_time(StrategySettings(search_rate=0.0)) == pytest.approx(2000.0 * math.pi)
