# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The wind triangle, by hand."""

import math

from lta_control.strategies.homing import solve_wind_triangle
import pytest

EAST = (7.0, 0.0)


def flown(line, wind, over_ground=0.5, top=1.0, least=0.0):
    return solve_wind_triangle(line, wind, over_ground, top, least)


def test_in_still_air_it_flies_along_the_line():
    assert flown((3.0, 3.0), (0.0, 0.0)) == (pytest.approx(math.pi / 4), pytest.approx(0.5))


def test_a_wind_across_is_met_by_the_nose():
    """3-4-5: 0.4 m/s along, 0.3 to the left against a wind to the right."""
    heading, speed = flown(EAST, (0.0, -0.3), 0.4)
    assert heading == pytest.approx(math.atan2(3.0, 4.0))
    assert speed == pytest.approx(0.5)


def test_a_head_wind_is_flown_against_as_fast_as_it_can():
    assert flown(EAST, (-0.3, 0.0)) == (pytest.approx(0.0), pytest.approx(0.8))
    assert flown(EAST, (-0.9, 0.0)) == (pytest.approx(0.0), pytest.approx(1.0))


def test_what_is_across_is_held_before_what_is_along():
    heading, speed = flown(EAST, (-0.9, 0.6))
    assert speed == pytest.approx(1.0)
    assert math.sin(heading) == pytest.approx(-0.6)


def test_a_tail_wind_carries_it_or_is_braked():
    assert flown(EAST, (0.8, 0.0), least=0.1) == (pytest.approx(0.0), pytest.approx(0.1))
    heading, speed = flown(EAST, (0.8, 0.0), least=-1.0)
    assert math.cos(heading) == pytest.approx(-1.0)
    assert speed == pytest.approx(0.3)


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


def test_a_line_in_any_direction():
    """Of the wind (0.2, 0.4), 0.2 m/s is along (-3, 4) / 5 and 0.4 m/s across, to the right."""
    heading, speed = flown((-3.0, 4.0), (0.2, 0.4), over_ground=0.5)
    along, left = 0.5 - (-0.6 * 0.2 + 0.8 * 0.4), 0.6 * 0.4 + 0.8 * 0.2
    assert heading == pytest.approx(math.atan2(4.0, -3.0) + math.atan2(left, along))
    assert speed == pytest.approx(math.hypot(along, left))
