# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
VL53L1x time-of-flight sensor, looking along the body's -z at the floor.

Standard deviation as in the Crazyflie firmware (zranger2.c): a (1 + exp(c (d - 2.5 m))) with
a = 2.5 mm and c = ln(0.2 / 0.0025) / 1.5 m; limits and accuracy from ST's manual. One ray stands
for the 27 degree cone, so that a tilted sensor reads height / cos(tilt).
"""

from dataclasses import dataclass
import math
from typing import final

from lta_model.measurement_chain import apply_chain, Chain, round_to_step
from numpy.random import Generator

RANGE_RESOLUTION = 1e-3  # m; the sensor counts millimetres
NOISE_KNEE = 2.5  # m; where the noise has doubled
NOISE_GROWTH = math.log(0.2 / 0.0025) / 1.5  # 1/m; 0.2 m more of noise at 4 m


@final
@dataclass(frozen=True, slots=True)
class RangeSettings:
    """Limits and errors of the sensor."""

    minimum: float = 0.04  # shortest distance [m]
    maximum: float = 4.0  # largest distance: in the dark; 0.7 m in strong light (long mode) [m]
    noise: float = 0.0025  # standard deviation near the floor [m]
    offset: float = 0.020  # largest offset, of a uniform distribution drawn for each flight [m]
    field_of_view: float = 27.0  # full angle [deg]


@final
@dataclass(frozen=True, slots=True)
class RangeErrors:
    """Error that stays constant during a flight: the offset [m]."""

    offset: float


def draw_errors(settings: RangeSettings, rng: Generator) -> RangeErrors:
    """Return the errors of one flight."""
    return RangeErrors(offset=settings.offset * float(rng.uniform(-1.0, 1.0)))


def noise_deviation(noise: float, distance: float) -> float:
    """Return the standard deviation of a reading at a distance; twice `noise` at 2.5 m [m]."""
    return noise * (1.0 + math.exp(NOISE_GROWTH * (distance - NOISE_KNEE)))


def slant_range(height: float, up: float, maximum: float) -> float:
    """Return the length of the one ray; infinite if it looks up or is beyond the reach [m]."""
    if up <= 0.0 or height > maximum * up:
        return math.inf
    return max(height, 0.0) / up


def read_range(
    distance: float, offset: float, noise: float, minimum: float, maximum: float
) -> float:
    """Return a distance with its errors, in whole mm; +-Inf beyond the limits (REP-117) [m]."""
    reading = distance + offset + noise
    if reading > maximum:
        return math.inf
    if reading < minimum:
        return -math.inf
    return round_to_step(reading, RANGE_RESOLUTION)


def measure_range(
    settings: RangeSettings,
    errors: RangeErrors,
    height: float,
    up: float,
    rng: Generator,
    chain: Chain = (),
    elapsed: float = 0.0,
) -> float:
    """
    Return one distance in whole mm; +Inf without return, -Inf below minimum (REP-117) [m].

    `height` is that of the sensor above the floor [m], `up` the cosine of the tilt. One random
    number is drawn whatever the reading, to keep seeds comparable. The effects in `chain` change
    the reading, not whether there is a return.
    """
    chance = float(rng.standard_normal())
    distance = slant_range(height, up, settings.maximum)
    if distance == math.inf:
        return distance
    noise = noise_deviation(settings.noise, distance) * chance
    if chain:
        distance = apply_chain(chain, (distance,), elapsed)[0]
    return read_range(distance, errors.offset, noise, settings.minimum, settings.maximum)
