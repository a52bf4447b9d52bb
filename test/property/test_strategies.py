"""Laws of every registered navigation strategy."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_control.strategies import STRATEGIES
from lta_control.strategies.protocol import Course, Sight
from lta_control.strategies.settings import StrategySettings
import pytest

SETTINGS = StrategySettings()
angle = st.floats(-math.pi, math.pi)
sights = st.lists(
    st.builds(
        Sight,
        seen=st.booleans(),
        bearing=angle,
        heading=angle,
        amplitudes=st.tuples(*[st.floats(0.0, 2000.0)] * 8),
        interval=st.just(0.1),
    ),
    min_size=1,
    max_size=8,
)
each = pytest.mark.parametrize('name', STRATEGIES)


def flown(strategy, heading, seen):
    memory = strategy.start(heading)
    courses = []
    for sight in seen:
        course, memory = strategy.steer(SETTINGS, memory, sight)
        courses.append((course, memory))
    return courses


@each
@given(heading=angle, seen=sights)
def test_courses_are_finite_and_no_faster_than_the_cruise(name, heading, seen):
    for course, memory in flown(STRATEGIES[name], heading, seen):
        assert isinstance(course, Course)
        assert math.isfinite(course.heading)
        assert 0.0 <= course.speed <= SETTINGS.speed
        assert isinstance(memory, tuple)
        assert all(isinstance(x, float) and math.isfinite(x) for x in memory)


@each
@given(heading=angle, seen=sights)
def test_the_same_again_gives_the_same_again(name, heading, seen):
    """Nothing is kept but the memory that is handed in and out."""
    first = flown(STRATEGIES[name], heading, seen)
    assert flown(STRATEGIES[name], heading, seen) == first


@each
@given(heading=angle)
def test_memory_begins_with_the_heading(name, heading):
    """The mission holds `memory[0]` while it climbs and lands."""
    assert STRATEGIES[name].start(heading)[0] == heading


@each
@given(heading=angle, seen=sights)
def test_memory_keeps_the_last_heading_asked_for(name, heading, seen):
    for course, memory in flown(STRATEGIES[name], heading, seen):
        assert memory[0] == course.heading
