# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Homing on lights made by hand: it follows what fits, waits, searches, arrives."""

import itertools
import math

from lta_control.strategies.homing import (
    reset_for_next_lamp,
    start,
    steer,
    watch,
)
from lta_control.strategies.protocol import LightMeasurement
from lta_control.strategies.settings import HomingSettings, StrategySettings
import pytest

# Lights at the height of the diodes, which it flies past
SETTINGS = StrategySettings(homing=HomingSettings(brake=False))
OWN = SETTINGS.homing
LAMP = (7.0, 0.0)


def sight(x, y, lamp=LAMP, share=1.0, heading=0.0):
    """Return what is seen of a lamp from a place, in still air; share is that of its light."""
    away = math.hypot(lamp[0] - x, lamp[1] - y)
    bearing = math.atan2(lamp[1] - y, lamp[0] - x) - heading
    strength = share * OWN.brightness / away**2
    return LightMeasurement(
        True, bearing, heading, (0.0,), 0.1, 0.02, strength, 0.0, (x, y), (0.4, 0.0)
    )


def blind(x, y):
    return LightMeasurement(False, 0.0, 0.0, (0.0,), 0.1, 0.0, 0.0, 0.0, (x, y), (0.4, 0.0))


def flown(sights, memory=None):
    courses, memory = [], start(0.0) if memory is None else memory
    for seen in sights:
        course, memory = steer(SETTINGS, memory, seen)
        courses.append(course)
    return courses, memory


def approach(seconds):
    """Return sights on the way to the lamp, at 0.4 m/s in still air."""
    return [sight(0.04 * k, 0.0) for k in range(round(10 * seconds))]


def test_against_wind_it_flies_the_last_metre_blind_as_fast_as_before():
    """The hull hides the lamp; who slowed down would be blown back, as 0.85 m/s would do here."""
    wind, memory = -0.85, start(0.0)
    for k in range(300):
        seen = sight(0.0085 * k, 0.0)._replace(position=(0.0935 * k, 0.0))
        course, memory = steer(SETTINGS, memory, seen)
    assert memory.fix.wind_x == pytest.approx(wind, abs=0.05)
    hidden = [blind(0.0, 0.0)._replace(position=(0.0935 * k, 0.0)) for k in range(300, 370)]
    courses, memory = flown(hidden, memory)
    assert memory.lost == pytest.approx(7.0)
    assert all(later.speed == pytest.approx(course.speed, abs=0.01) for later in courses)
    assert course.speed == pytest.approx(OWN.top_speed)


def test_after_a_long_one_it_turns_and_then_flies_circles_that_widen():
    _, memory = flown(approach(3.0))
    courses, memory = flown([blind(1.2, 0.0)] * round(10 * OWN.hold + 10), memory)
    turn = round(10 * 2.0 * math.pi / SETTINGS.search_rate)
    courses, memory = flown([blind(1.2, 0.0)] * (3 * turn), memory)
    on_the_spot, circles = courses[: turn - 20], courses[turn + 10 :]
    assert all(course.speed == 0.0 for course in on_the_spot)
    assert all(course.speed == SETTINGS.speed for course in circles)
    steps = [b.heading - a.heading for a, b in itertools.pairwise(circles)]
    assert steps == sorted(steps, reverse=True)
    assert steps[0] > 2.0 * steps[-1] > 0.0


def test_an_echo_is_not_taken_for_the_lamp_before_a_whole_turn():
    """There is nothing else for longer than `hold`: it looks all around before it follows."""
    _, memory = flown(approach(4.0))
    echo = sight(1.6, 0.0, lamp=(1.6, 5.0), share=0.05)
    _, memory = flown([echo] * round(10 * (OWN.hold + 5.0)), memory)
    assert memory.searched > 0.0
    assert abs(math.atan2(memory.fix.y, memory.fix.x)) < 0.1
    turn = round(20.0 * math.pi / SETTINGS.search_rate)
    _, memory = flown([echo] * turn, memory)
    assert math.atan2(memory.fix.y, memory.fix.x) == pytest.approx(math.pi / 2, abs=0.2)


def test_a_far_stronger_light_on_the_same_bearing_is_another_lamp():
    """It followed an echo, and the lamp comes out behind it: 50 times what fits."""
    _, memory = flown(approach(4.0))
    fitting = memory.fix
    lamp = sight(1.6, 0.0, lamp=(2.36, 0.0))
    _, memory = flown([lamp] * round(10 * OWN.doubt - 2), memory)
    assert memory.fix.brightness == pytest.approx(fitting.brightness, abs=1e-6)
    _, memory = flown([lamp] * 5, memory)
    assert math.hypot(memory.fix.x, memory.fix.y) == pytest.approx(0.76, rel=0.1)


def test_it_arrives_slows_down_and_stays():
    courses, memory = flown([sight(0.04 * k, 0.0) for k in range(160)])
    assert courses[-1].arrived
    assert courses[-1].speed < 0.2
    first = next(k for k, course in enumerate(courses) if course.arrived)
    assert 7.0 - 0.04 * first == pytest.approx(OWN.arrival, abs=0.15)
    assert courses[first - 1].speed < 0.5 * courses[0].speed
    courses, _ = flown([sight(5.9, 0.0)] * 20, memory)
    assert courses[-1].arrived  # blown off a little it has still arrived


def test_wind_is_learnt_in_the_climb_and_kept_for_the_next_lamp():
    """The air carries the drone to the right while it believes to stand."""
    memory = start(0.5)
    for k in range(60):
        seen = sight(0.0, -0.03 * k)._replace(position=(0.0, 0.0))
        memory = watch(SETTINGS, memory, seen)
    assert memory.heading == 0.5
    assert memory.fix.wind_y == pytest.approx(-0.3, abs=0.05)
    after = reset_for_next_lamp(memory)
    assert not after.has_fix
    courses, after = flown([sight(0.0, -1.8)._replace(position=(0.0, 0.0))], after)
    assert after.fix.wind_y == memory.fix.wind_y
    assert courses[0].heading > math.atan2(1.8, 7.0) + 0.3  # it leans into the wind at once
