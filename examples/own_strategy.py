# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A strategy of your own: turn towards the lamp first, then fly, and search the way it was lost.

`lta fly --strategy examples/own_strategy.py` flies it. docs/strategies.md explains the interface.
"""

import math
from typing import NamedTuple

from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy, SteeringCommand
from lta_control.strategies.settings import StrategySettings

NARROW = 0.6  # rad; beyond this bearing the drone turns without flying


class TurnFirstMemory(NamedTuple):
    """What the strategy knows: the last commanded heading, and the side of the lamp (1: left)."""

    heading: float
    side: float


def start(heading: float) -> TurnFirstMemory:
    """Return the memory before the first light: hold the heading, search to the left."""
    return TurnFirstMemory(heading, 1.0)


def steer(
    settings: StrategySettings, memory: TurnFirstMemory, sight: LightMeasurement
) -> tuple[SteeringCommand, TurnFirstMemory]:
    """Return heading and speed for one block of light (every 100 ms)."""
    if not sight.seen:
        heading = memory.heading + memory.side * settings.search_rate * sight.interval
        return SteeringCommand(heading, 0.0, False), TurnFirstMemory(heading, memory.side)
    heading = sight.heading + sight.bearing
    # Full speed straight ahead, none beyond NARROW
    speed = settings.speed * max(0.0, 1.0 - abs(sight.bearing) / NARROW)
    return SteeringCommand(heading, speed, False), TurnFirstMemory(
        heading, math.copysign(1.0, sight.bearing)
    )


STRATEGY = NavigationStrategy('turn_first', start, steer)
