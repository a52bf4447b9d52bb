# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The strategies by name, and BAG."""

import math

from lta_control.strategies import find_navigation_strategy
from lta_control.strategies.bearing_angle import (
    BEARING_ANGLE_STRATEGY,
    mean_bearing,
)
from lta_control.strategies.protocol import LightMeasurement, SteeringCommand
from lta_control.strategies.settings import BearingAngleSettings, StrategySettings
import pytest

SETTINGS = StrategySettings(speed=0.4, search_rate=0.2)
SEEN = LightMeasurement(seen=True, bearing=-0.5, heading=2.0, amplitudes=(1.0,) * 8, interval=0.1)
BLIND = SEEN._replace(seen=False, bearing=0.0)


def test_bag_is_known():
    assert find_navigation_strategy('bag') is BEARING_ANGLE_STRATEGY
    assert (BEARING_ANGLE_STRATEGY.arrives, BEARING_ANGLE_STRATEGY.ranges) == (False, False)


def test_bag_heads_for_the_lamp():
    course, memory = BEARING_ANGLE_STRATEGY.steer(SETTINGS, (9.0,), SEEN)
    assert course == SteeringCommand(1.5, 0.4)
    assert memory == (1.5,)


def test_blind_it_stops_and_turns():
    bag, memory = BEARING_ANGLE_STRATEGY, (1.0,)
    for turned in (1.02, 1.04, 1.06):
        course, memory = bag.steer(SETTINGS, memory, BLIND)
        assert course == SteeringCommand(pytest.approx(turned), 0.0)
    course, memory = bag.steer(SETTINGS, memory, BLIND._replace(interval=1.0))
    assert course.heading == pytest.approx(1.26)


def test_it_searches_from_where_the_lamp_was_last():
    bag = BEARING_ANGLE_STRATEGY
    _, memory = bag.steer(SETTINGS, bag.start(0.3), SEEN)
    assert bag.steer(SETTINGS, memory, BLIND)[0] == SteeringCommand(pytest.approx(1.52), 0.0)


def test_bag_heads_along_the_mean_of_the_paper_on_request():
    """Cosine diodes of an even ring: their weighted mean is exact, `lta_vlc.bearing`."""
    lamp = 0.7
    seen = tuple(max(math.cos(lamp - math.tau * k / 8), 0.0) for k in range(8))
    settings = StrategySettings(bag=BearingAngleSettings(mean=True))
    course, _ = BEARING_ANGLE_STRATEGY.steer(settings, (9.0,), SEEN._replace(amplitudes=seen))
    assert course.heading == pytest.approx(2.0 + lamp)
    assert mean_bearing(seen) == pytest.approx(lamp)
