# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Laws of every registered navigation strategy."""

import math

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_control.strategies import STRATEGIES
from lta_control.strategies.protocol import keep_memory, LightMeasurement, SteeringCommand
from lta_control.strategies.settings import StrategySettings
import pytest

SETTINGS = StrategySettings()
FASTEST = max(SETTINGS.speed, SETTINGS.homing.top_speed)  # homing flies faster against wind
angle = st.floats(-math.pi, math.pi)
place, speed = st.floats(-30.0, 30.0), st.floats(-2.0, 2.0)
sights = st.lists(
    st.builds(
        LightMeasurement,
        seen=st.booleans(),
        bearing=angle,
        heading=angle,
        amplitudes=st.tuples(*[st.floats(0.0, 2000.0)] * 8),
        interval=st.just(0.1),
        deviation=st.floats(0.0, 1.0),
        strength=st.floats(0.0, 4000.0),
        elevation=st.floats(-1.5, 1.5),
        position=st.tuples(place, place),
        drift=st.tuples(speed, speed),
    ),
    min_size=1,
    max_size=30,
)
laws = settings(max_examples=40)  # of up to thirty sights each, of which most is drawing them
each = pytest.mark.parametrize('name', STRATEGIES)
WATCHING = [name for name, strategy in STRATEGIES.items() if strategy.watch is not keep_memory]


def numbers(value):
    """Return all numbers of nested tuples; what is true or false is none."""
    if isinstance(value, tuple):
        return [number for item in value for number in numbers(item)]
    return [] if isinstance(value, bool) else [value]


def flown(strategy, heading, seen):
    memory = strategy.start(heading)
    courses = []
    for sight in seen:
        course, memory = strategy.steer(SETTINGS, memory, sight)
        courses.append((course, memory))
    return courses


@each
@laws
@given(heading=angle, seen=sights)
def test_courses_are_finite_and_no_faster_than_the_cruise(name, heading, seen):
    for course, memory in flown(STRATEGIES[name], heading, seen):
        assert isinstance(course, SteeringCommand)
        assert math.isfinite(course.heading)
        # Backwards, it flies no faster either
        assert abs(course.speed) <= FASTEST * (1.0 + 1e-12)
        assert isinstance(course.arrived, bool)
        assert isinstance(memory, tuple)
        assert all(isinstance(x, float) and math.isfinite(x) for x in numbers(memory))


@each
@laws
@given(heading=angle, seen=sights)
def test_the_same_again_gives_the_same_again(name, heading, seen):
    """Nothing is kept but the memory that is handed in and out."""
    first = flown(STRATEGIES[name], heading, seen)
    assert flown(STRATEGIES[name], heading, seen) == first


@each
@laws
@given(heading=angle, seen=sights)
def test_who_never_arrives_never_says_so(name, heading, seen):
    """And one that does, does not before it has seen any light."""
    strategy = STRATEGIES[name]
    courses = flown(strategy, heading, seen)
    assert strategy.arrives or not any(course.arrived for course, _ in courses)
    blind = [sight._replace(seen=False, strength=0.0) for sight in seen]
    assert not any(course.arrived for course, _ in flown(strategy, heading, blind))


@pytest.mark.parametrize('name', WATCHING)
@laws
@given(heading=angle, seen=sights)
def test_what_is_learnt_in_the_climb_keeps_the_heading(name, heading, seen):
    strategy = STRATEGIES[name]
    memory = strategy.start(heading)
    for sight in seen:
        memory = strategy.watch(SETTINGS, memory, sight)
        assert memory[0] == heading
        assert all(math.isfinite(x) for x in numbers(memory))


@each
@laws
@given(turned=st.floats(-3.0, 3.0), seen=sights)
def test_no_heading_is_special(name, turned, seen):
    """Turn the odom frame, and the courses turn with it."""
    cos, sin = math.cos(turned), math.sin(turned)
    seen = [sight._replace(interval=0.1) for sight in seen]
    also = [
        sight._replace(
            heading=sight.heading + turned,
            position=(
                cos * sight.position[0] - sin * sight.position[1],
                sin * sight.position[0] + cos * sight.position[1],
            ),
        )
        for sight in seen
    ]
    one, two = (
        flown(STRATEGIES[name], 0.3, seen[:4]),
        flown(STRATEGIES[name], 0.3 + turned, also[:4]),
    )
    for (course, _), (other, _) in zip(one, two, strict=True):
        assert other.speed == pytest.approx(course.speed, abs=1e-4)
        off = other.heading - course.heading - turned
        assert math.cos(off) == pytest.approx(1.0, abs=1e-6)


@each
@laws
@given(heading=angle)
def test_memory_begins_with_the_heading(name, heading):
    """The mission holds `memory[0]` while it climbs and lands."""
    assert STRATEGIES[name].start(heading)[0] == heading


@each
@laws
@given(heading=angle, seen=sights)
def test_memory_keeps_the_last_heading_asked_for(name, heading, seen):
    for course, memory in flown(STRATEGIES[name], heading, seen):
        assert memory[0] == course.heading
