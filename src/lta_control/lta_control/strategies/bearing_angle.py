# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
BAG, bearing angle guidance: head along the lamp's bearing (the paper's first strategy).

The bearing is that of our fit, or with `mean` the paper's: the angle of the sum of the axes of an
even ring, weighted by what each diode sees of the lamp. With no lamp in sight the drone stops and
turns, so that it sees the light from any start. The memory is the last commanded heading.
"""

import math

from lta_control.strategies.protocol import (
    LightMeasurement,
    Memory,
    NavigationStrategy,
    SteeringCommand,
)
from lta_control.strategies.settings import StrategySettings


def start(heading: float) -> Memory:
    """Return the memory before the first sight: hold the heading."""
    return (heading,)


def steer(
    settings: StrategySettings, memory: Memory, sight: LightMeasurement
) -> tuple[SteeringCommand, Memory]:
    """Return the heading of the lamp at cruise speed, or a slow turn on the spot."""
    bearing = mean_bearing(sight.amplitudes) if settings.bag.mean else sight.bearing
    heading, speed = sight.heading + bearing, settings.speed
    if not sight.seen:
        heading, speed = memory[0] + settings.search_rate * sight.interval, 0.0
    return SteeringCommand(heading, speed, False), (heading,)


def mean_bearing(amplitudes: tuple[float, ...]) -> float:
    """Return the angle of the weighted sum of the axes of an even ring [rad, body]."""
    x = y = 0.0
    for k in range(len(amplitudes)):
        x += amplitudes[k] * math.cos(math.tau * k / len(amplitudes))
        y += amplitudes[k] * math.sin(math.tau * k / len(amplitudes))
    return math.atan2(y, x)


BEARING_ANGLE_STRATEGY = NavigationStrategy('bag', start, steer)
