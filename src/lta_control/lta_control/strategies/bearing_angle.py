"""
BAG, bearing angle guidance: head along the lamp's bearing (the paper's first strategy).

With no lamp in sight the drone stops and turns, so that it sees the light from any start. The
memory is the last commanded heading.
"""

from typing import TYPE_CHECKING

from lta_control.strategies.protocol import (
    LightMeasurement,
    Memory,
    NavigationStrategy,
    SteeringCommand,
)

if TYPE_CHECKING:
    from lta_control.strategies.settings import StrategySettings


def start(heading: float) -> Memory:
    """Return the memory before the first sight: hold the heading."""
    return (heading,)


def steer(
    settings: 'StrategySettings', memory: Memory, sight: LightMeasurement
) -> tuple[SteeringCommand, Memory]:
    """Return the heading of the lamp at cruise speed, or a slow turn on the spot."""
    heading, speed = sight.heading + sight.bearing, settings.speed
    if not sight.seen:
        heading, speed = memory[0] + settings.search_rate * sight.interval, 0.0
    return SteeringCommand(heading, speed, False), (heading,)


STRATEGY = NavigationStrategy('bag', start, steer)
