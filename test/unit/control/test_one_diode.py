# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""DES and DGA: one diode, by hand."""

import math

from lta_control.strategies import dither, gradient
from lta_control.strategies.dither import DitherState
from lta_control.strategies.gradient import (
    add_pair,
    EMPTY_SAMPLES,
    GradientState,
    NO_SAMPLE,
    steepest_heading,
)
from lta_control.strategies.protocol import LightMeasurement
from lta_control.strategies.settings import (
    DitherSettings,
    GradientSettings,
    MAP_SAMPLES,
    StrategySettings,
)
import numpy as np
import pytest


def light(amplitude, heading=0.0):
    return LightMeasurement(True, 0.0, heading, (amplitude, 0.0), 0.1)


def test_des_swings_about_its_estimate():
    settings = StrategySettings()
    memory, headings = dither.start(0.2), []
    for _ in range(420):
        course, memory = dither.steer(settings, memory, light(100.0))
        headings.append(course.heading)
    assert max(headings) - 0.2 == pytest.approx(math.pi / 2, abs=0.01)
    assert min(headings) - 0.2 == pytest.approx(-math.pi / 2, abs=0.01)
    assert headings[104] == pytest.approx(0.2 + math.pi / 2 * math.cos(0.3 * 10.5))
    assert memory.estimate == 0.2  # even light says nothing


def turned(own, before, after, heading):
    """Return by how much the estimate moves when light changes at a heading; it stood at 0."""
    settings = StrategySettings(des=own)
    memory = DitherState(0.0, 0.0, 0.0, True, math.log(before + own.floor), math.log(100.0))
    return dither.steer(settings, memory, light(after, heading))[1].estimate


def test_des_scans_by_level_and_climbs_by_rate():
    """Two halves of one gain: light that is there on the left, light that grows on the left."""
    scan, climb = DitherSettings(scan=0.3, gradient=0.0), DitherSettings(scan=0.0, gradient=1.0)
    assert turned(scan, 200.0, 200.0, 0.5) > 0.0 > turned(scan, 200.0, 200.0, -0.5)
    assert turned(climb, 200.0, 200.0, 0.5) == 0.0
    grown = math.log(205.0 / 105.0) * math.sin(0.5)
    assert turned(climb, 100.0, 200.0, 0.5) == pytest.approx(grown)
    assert turned(climb, 100.0, 200.0, -0.5) == pytest.approx(-grown)
    mean = math.log(100.0) + 0.1 / 15.0 * (math.log(205.0) - math.log(100.0))
    level = 0.3 * 0.1 * (math.log(205.0) - mean) * math.sin(0.5)
    assert turned(scan, 200.0, 200.0, 0.5) == pytest.approx(level)


def plane(a, b, c, places):
    pairs = [(float(x), float(y), float(a * x + b * y + c)) for x, y in places]
    return (NO_SAMPLE,) * (MAP_SAMPLES - len(pairs)) + tuple(pairs)


def test_the_paper_s_plane_without_a_constant_points_away_from_the_origin():
    """Light of 50 counts at 3 m, 3 m is all slope to it: 45 degrees, whatever the truth is."""
    places = np.random.default_rng(2).normal(3.0, 0.3, (20, 2))
    own = GradientSettings(ridge=1e-9, centred=False)
    found = steepest_heading(own, plane(-0.3, 0.3, 50.0, places), 20.0, 9.0)
    assert found == pytest.approx(math.pi / 4, abs=0.2)
    right = steepest_heading(own, plane(-0.3, 0.3, 0.0, places), 20.0, 9.0)
    assert right == pytest.approx(math.atan2(0.3, -0.3), abs=1e-6)  # a plane that is 0 there


def test_places_on_a_line_give_the_slope_along_it():
    own = GradientSettings()
    places = [(0.05 * k, 0.0) for k in range(20)]
    assert steepest_heading(own, plane(2.0, 5.0, 9.0, places), 20.0, 9.0) == pytest.approx(0.0)
    assert steepest_heading(own, plane(0.0, 0.0, 9.0, places), 20.0, 9.0) == 9.0


def test_the_mean_of_des_does_not_pass_the_newest_light():
    """20 s exceed the washout of 15 s: the mean is the level, and the estimate does not turn."""
    settings = StrategySettings(des=DitherSettings(scan=0.3, gradient=0.0))
    memory = DitherState(0.0, 0.0, 1.0, True, 0.0, math.log(50.0))
    late = light(100.0, 0.5)._replace(interval=20.0)
    course, memory = dither.steer(settings, memory, late)
    assert memory == DitherState(
        course.heading, 0.0, 21.0, True, math.log(105.0), pytest.approx(math.log(105.0))
    )
    assert (course.speed, course.arrived) == (settings.speed, False)


def test_the_first_mean_of_des_is_the_first_level():
    settings = StrategySettings(des=DitherSettings(scan=0.3, gradient=1.0))
    _, memory = dither.steer(settings, dither.start(0.2), light(100.0, 1.0))
    assert memory[1:] == (0.2, 0.1, True, math.log(105.0), math.log(105.0))


def test_the_plane_is_a_ridge_regression_of_the_newest_pairs():
    """numpy solves the normal equations of the newest 12 pairs; older ones must not count."""
    chance = np.random.default_rng(9)
    newest = chance.normal(0.0, 0.3, (12, 3)) + np.array((1.0, -2.0, 50.0))
    older = ((9.0, 9.0, 900.0),) * (MAP_SAMPLES - 12)
    pairs = older + tuple(map(tuple, newest.tolist()))
    for centred in (True, False):
        own = GradientSettings(ridge=0.05, centred=centred)
        rows = newest - newest.mean(axis=0) if centred else newest
        places, levels = rows[:, :2], rows[:, 2]
        slope = np.linalg.solve(places.T @ places + 12 * 0.05 * np.eye(2), places.T @ levels)
        assert steepest_heading(own, pairs, 12.0, 9.0) == pytest.approx(
            math.atan2(slope[1], slope[0])
        )


@pytest.mark.parametrize(
    ('place', 'more'),
    [((-0.001, 0.03), 1.0), ((0.001, 0.039), 0.0), ((0.001, 0.041), 1.0), ((0.021, 0.03), 1.0)],
)
def test_a_cell_is_2_cm_wide_in_both_directions(place, more):
    before = (*EMPTY_SAMPLES[1:], (0.001, 0.03, 10.0))
    pairs, added = add_pair(before, 1.0, (*place, 30.0), 0.02)
    assert added == more
    assert pairs[-1] == (*place, 30.0 if more else 20.0)
    assert len(pairs) == MAP_SAMPLES
    assert add_pair(before, 0.0, (0.001, 0.03, 30.0), 0.02)[1] == 1.0  # without earlier pairs


OWN = GradientSettings(least=3.0, computing=0.5, arc=0.4)
FLOWN = StrategySettings(dga=OWN)
BRIGHTER = ((0.0, 0.0, 1.0), (0.1, 0.0, 2.0), (0.0, 0.1, 1.0))  # brighter along x


def ascending(**changes):
    """Return the memory of a drone with three pairs that flies along a heading of 0.5 rad."""
    memory = GradientState(
        0.5, 1.0, 2.0, 0.4, 0.5, 0.7, 0.0, False, 3.0, EMPTY_SAMPLES[3:] + BRIGHTER
    )
    return memory._replace(**changes)


def ascended(memory, heading=0.5):
    return gradient.steer(FLOWN, memory, light(1.0, heading)._replace(interval=0.25))


def test_dga_reckons_its_place_along_the_commanded_heading():
    _, memory = ascended(ascending())
    assert memory.x == pytest.approx(1.0 + 0.1 * math.cos(0.5))
    assert memory.y == pytest.approx(2.0 + 0.1 * math.sin(0.5))
    assert memory.pairs[-1] == (memory.x, memory.y, 1.0)
    assert (memory.filled, memory.speed) == (4.0, FLOWN.speed)
    assert ascended(ascending(filled=float(MAP_SAMPLES)))[1].filled == MAP_SAMPLES


def test_dga_takes_its_first_pairs_on_an_arc():
    course, memory = ascended(ascending(filled=1.0), 3.0)
    assert (course.heading, course.speed) == (pytest.approx(0.5 + 0.4 * 0.25), FLOWN.speed)
    assert (memory.target, memory.next) == (course.heading, course.heading)
    assert (memory.computed, memory.turning) == (0.5, False)
    course, memory = ascended(ascending(filled=2.0))  # with the third pair the arc ends
    assert (course.heading, memory.computed) == (0.5, 0.25)


def test_dga_uses_a_heading_after_the_computing_time():
    course, memory = ascended(ascending(computed=0.125))
    assert (course.heading, memory.next, memory.computed) == (0.5, 0.7, 0.375)
    course, memory = ascended(ascending(computed=0.25))
    assert (course.heading, memory.target, memory.computed) == (0.7, 0.7, 0.0)
    assert memory.next == steepest_heading(OWN, memory.pairs, 4.0, 0.5)


@pytest.mark.parametrize(
    ('off', 'turning', 'stands'),
    [(1.19, False, False), (1.21, False, True), (0.51, True, True), (0.49, True, False)],
)
def test_dga_stops_to_turn_beyond_1_2_rad_and_flies_on_within_half_a_radian(off, turning, stands):
    for side in (-off, off):
        course, memory = ascended(ascending(turning=turning), 0.5 + side)
        assert (course.speed == 0.0, memory.turning) == (stands, stands)
        assert memory.speed == course.speed


@pytest.mark.parametrize(('commanded', 'turned'), [(False, 0.0), (True, 0.5)])
def test_dga_reckons_by_the_heading_of_its_imu_or_by_the_commanded_one(commanded, turned):
    """Commanded to 0.5 rad at 0.5 m/s, the nose is still at 0."""
    settings = StrategySettings(dga=GradientSettings(commanded_heading=commanded))
    memory = gradient.start(0.5)._replace(speed=0.5)
    after = gradient.steer(settings, memory, light(100.0, heading=0.0))[1]
    assert (after.x, after.y) == pytest.approx((0.05 * math.cos(turned), 0.05 * math.sin(turned)))
