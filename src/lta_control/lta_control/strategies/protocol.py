# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Interface of a navigation strategy: from the light to a course."""

from collections.abc import Callable
from dataclasses import dataclass
import math
from typing import Any, final, NamedTuple

from lta_control.strategies.settings import StrategySettings

Memory = tuple[Any, ...]  # numbers and tuples of numbers; the first is the last commanded heading


class LightMeasurement(NamedTuple):
    """Light of one block, at the middle of the block."""

    seen: bool  # whether the lamp is seen
    # Of the lamp in the body frame, counter-clockwise; 0 where it is not seen [rad]
    bearing: float
    heading: float  # of the drone, in the odom frame, at the same instant [rad]
    amplitudes: tuple[float, ...]  # light at the beacon's frequency by diode [ADC counts]
    interval: float  # time since the last sight [s]
    deviation: float = 0.0  # standard deviation of the bearing [rad]
    # Light on a diode that faces the lamp, without the pedestal, scaled to a resistor of 100 kohm;
    # 0 where it is not seen [ADC counts]
    strength: float = 0.0
    elevation: float = 0.0  # of the lamp over the body's horizon; 0 where it is unknown [rad]
    # x and y by dead reckoning through the air, without the wind [m, odom]
    position: tuple[float, float] = (0.0, 0.0)
    # Estimated airspeed forward and to the left [m/s, body]
    drift: tuple[float, float] = (0.0, 0.0)


class SteeringCommand(NamedTuple):
    """Course of the strategy."""

    heading: float  # in the odom frame [rad]
    speed: float  # forward airspeed [m/s]
    arrived: bool = False  # whether the strategy considers itself at the lamp


def keep_memory(
    settings: StrategySettings,
    memory: Memory,
    sight: LightMeasurement,
) -> Memory:
    """Return the memory unchanged, for a strategy that learns nothing during the climb."""
    return memory


def leave_distance_unknown(memory: Memory) -> float:
    """Return NaN, for a strategy that does not estimate its distance to the lamp."""
    return math.nan


def keep_lamp(memory: Memory) -> Memory:
    """Return the memory unchanged, for a strategy that never arrives."""
    return memory


@final
@dataclass(frozen=True, slots=True)
class NavigationStrategy:
    """
    A navigation strategy: plain functions of scalars and tuples with memory in and out.

    A new one needs one file with its functions and a `STRATEGY`; docs/add.md lists the rest.
    """

    name: str  # name in launch files
    start: Callable[[float], Memory]  # `start(heading) -> memory` before the first sight
    # `steer(settings, memory, sight) -> (course, memory)`
    steer: Callable[[StrategySettings, Any, LightMeasurement], tuple[SteeringCommand, Memory]]
    # `watch(settings, memory, sight) -> memory` during the climb, before it may steer; keeps the
    # heading
    watch: Callable[[StrategySettings, Any, LightMeasurement], Memory] = keep_memory
    # `onward(memory) -> memory` when the drone has arrived and continues to another lamp. Required
    # for a route of several lamps.
    onward: Callable[[Any], Memory] = keep_lamp
    ranges: bool = False  # whether it uses `LightMeasurement.strength`, which needs the resistor
    # `distance(memory) -> horizontal distance to the lamp` [m], NaN where it is unknown
    distance: Callable[[Any], float] = leave_distance_unknown
    file: str = ''  # path of the user's file that defines it; empty for a strategy of LTA

    @property
    def arrives(self) -> bool:
        """Whether it ever reports an arrival."""
        return self.onward is not keep_lamp
