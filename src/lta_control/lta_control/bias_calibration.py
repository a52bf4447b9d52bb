# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Calibrate the sensor biases while the drone is at rest on level ground.

The mean IMU readings at rest are the biases. The mean pressure, reduced to the floor, is the zero
of the pressure height. The calibration restarts when the drone is moved. A floating drone sways,
so the limits are above what wind does to a drone that stands on the floor (6 deg/s and 0.03 g off
the mean in a gusty hall). Its mean is then nearly that of a drone at rest.
"""

import math
from typing import Final, NamedTuple

from lta_config.constants import STANDARD_GRAVITY
from lta_control.motion import Vector

MOVED_RATE: Final = math.radians(10.0)  # rad/s off the mean; a hand turns it faster
MOVED_FORCE: Final = 0.1 * STANDARD_GRAVITY  # m/s2 off the mean
# Three times the IMU data sheet's bias range, around the bias in the vehicle file. A larger
# value means that the drone turns or is tilted.
MOST_RATE: Final = math.radians(3.0)  # rad/s
MOST_FORCE: Final = 0.06 * STANDARD_GRAVITY  # m/s2


class RestSums(NamedTuple):
    """Sums of the samples at rest; their means are the biases."""

    samples: int = 0
    rates: Vector = (0.0, 0.0, 0.0)
    force: Vector = (0.0, 0.0, 0.0)
    pressure: float = 0.0
    pressures: int = 0


class SensorBiases(NamedTuple):
    """Sensor readings at rest minus the true values."""

    rates: Vector = (0.0, 0.0, 0.0)  # [rad/s]
    force: Vector = (0.0, 0.0, 0.0)  # [m/s2]
    pressure: float = 0.0  # at the floor [Pa]


def rest_step(rest: RestSums, rates: Vector, force: Vector, pressure: float) -> RestSums:
    """
    Return the sums with one more sample; restart with that sample if the drone was moved.

    `rates` [rad/s] and specific force `force` [m/s2] are in the body frame; `pressure` is NaN
    where there is no measurement. [Pa]
    """
    before = reset_unless_still(rest, not _is_disturbed(rest, rates, force))
    w, f, air = before.rates, before.force, before.pressure
    has_pressure = math.isfinite(pressure)
    return RestSums(
        before.samples + 1,
        (w[0] + rates[0], w[1] + rates[1], w[2] + rates[2]),
        (f[0] + force[0], f[1] + force[1], f[2] + force[2]),
        air + pressure if has_pressure else air,
        before.pressures + (1 if has_pressure else 0),
    )


def reset_unless_still(rest: RestSums, still: bool) -> RestSums:
    """Return the sums, or zeros if `still` is False."""
    # Multiplied rather than branched, so that the compiled types stay the same.
    one = 1 if still else 0
    w, f = rest.rates, rest.force
    return RestSums(
        one * rest.samples,
        (one * w[0], one * w[1], one * w[2]),
        (one * f[0], one * f[1], one * f[2]),
        one * rest.pressure,
        one * rest.pressures,
    )


def _is_disturbed(rest: RestSums, rates: Vector, force: Vector) -> bool:
    """Return whether a sample is farther from the running mean than swaying at rest explains."""
    if rest.samples == 0:
        return False
    n = 1.0 * rest.samples
    return _exceeds_limit(rates, rest.rates, n, MOVED_RATE) or _exceeds_limit(
        force, rest.force, n, MOVED_FORCE
    )


def _exceeds_limit(sample: Vector, sums: Vector, n: float, limit: float) -> bool:
    return (
        abs(sample[0] - sums[0] / n) > limit
        or abs(sample[1] - sums[1] / n) > limit
        or abs(sample[2] - sums[2] / n) > limit
    )


def is_turning(biases: SensorBiases, expected: Vector) -> bool:
    """
    Return whether the mean rates are too large for a gyroscope bias.

    `expected` is the gyroscope bias in the vehicle file. [rad/s]
    """
    return largest_deviation(biases.rates, expected) > MOST_RATE


def is_tilted(biases: SensorBiases, expected: Vector) -> bool:
    """Return whether the mean force indicates a tilt; `expected` [m/s2] as in `is_turning`."""
    return largest_deviation(biases.force, expected) > MOST_FORCE


def largest_deviation(measured: Vector, expected: Vector) -> float:
    """Return the largest difference from the expected values over the axes, in their unit."""
    x, y, z = measured[0] - expected[0], measured[1] - expected[1], measured[2] - expected[2]
    return max(abs(x), abs(y), abs(z))


def compute_biases(rest: RestSums, height: float, air_density: float) -> SensorBiases:
    """
    Return the biases from the means, assuming level ground.

    `rest` has at least one sample and one pressure. `height` is that of the hull centre above the
    floor [m], and `air_density` [kg/m3] gives the pressure at the floor.
    """
    n = 1.0 * rest.samples
    return SensorBiases(
        (rest.rates[0] / n, rest.rates[1] / n, rest.rates[2] / n),
        # At rest on level ground the true specific force is +g along body z
        (rest.force[0] / n, rest.force[1] / n, rest.force[2] / n - STANDARD_GRAVITY),
        # Reduced to the floor with the hydrostatic equation.
        rest.pressure / rest.pressures + air_density * STANDARD_GRAVITY * height,
    )
