# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
r"""
Convert the demodulator's output of one block to a `LightMeasurement` for the strategies.

The node takes the numbers from messages, the one-process loop from what the messages would carry.
The lamp is a point with a covariance that is long along its bearing ray
(`lta_vlc.lamp.estimate_lamp_position`). To first order the variance across that ray is
:math:`(d^2 + \sigma_d^2)\,\sigma^2`, with d the distance of the point, :math:`\sigma_d` its
deviation along the ray and :math:`\sigma` that of the bearing, which is recovered from it.

The strength is what a diode that faces the lamp would measure. With an even ring of N cosine
diodes :math:`|\sum M_i n_i| = N M / 4` at every bearing (`lta_vlc.lamp`), and a pedestal that
is the same for all cancels.
"""

import math
from typing import NamedTuple

from lta_control.motion import DeadReckonedMotion
from lta_control.strategies.protocol import LightMeasurement

Spread = tuple[float, float, float]


class LampPosition(NamedTuple):
    """A lamp in the body frame: where [m], and the xx, xy and yy of its covariance [m2]."""

    x: float
    y: float
    z: float
    spread: Spread


class LampDirection(NamedTuple):
    """Whether the lamp is seen, and where in the body frame; zeros where it is not [rad]."""

    seen: bool
    bearing: float
    elevation: float
    deviation: float  # standard deviation of the bearing


UNSEEN = LampDirection(False, 0.0, 0.0, 0.0)


def build_sight(
    lamp: LampPosition | None,
    axes: tuple[tuple[float, float], ...],
    amplitudes: tuple[float, ...],
    reckoned: DeadReckonedMotion,
    interval: float,
    scale: float = 1.0,
) -> LightMeasurement:
    """
    Return the sight of one block.

    Parameters
    ----------
    lamp : LampPosition or None
        Estimated lamp; None where it is not seen.
    axes : tuple of tuple of float
        Diode axes along body x and y.
    amplitudes : tuple of float
        By diode. [ADC counts]
    reckoned : DeadReckonedMotion
        Motion at the middle of the block.
    interval : float
        Time since the last sight. [s]
    scale : float
        Gain of the photodiodes' resistor relative to one of 100 kohm. [1]

    """
    # A diode without valid samples counts as dark.
    amplitudes = tuple([a if math.isfinite(a) else 0.0 for a in amplitudes])
    direction = UNSEEN
    if lamp is not None:
        direction = LampDirection(
            True,
            math.atan2(lamp.y, lamp.x),
            math.atan2(lamp.z, math.hypot(lamp.x, lamp.y)),
            bearing_deviation(lamp),
        )
    # An empty tuple means that the block could not be read.
    return sight_from_direction(direction, axes, amplitudes or (0.0,), reckoned, interval, scale)


def sight_from_direction(
    lamp: LampDirection,
    axes: tuple[tuple[float, float], ...],
    amplitudes: tuple[float, ...],
    reckoned: DeadReckonedMotion,
    interval: float,
    scale: float,
) -> LightMeasurement:
    """Return the sight of one block from the direction of the lamp; see `build_sight`."""
    strength = facing_strength(axes, amplitudes) / scale if lamp.seen else 0.0
    return LightMeasurement(
        lamp.seen,
        lamp.bearing,
        reckoned.heading,
        amplitudes,
        interval,
        lamp.deviation,
        strength,
        lamp.elevation,
        (reckoned.x, reckoned.y),
        (reckoned.forward, reckoned.left),
    )


def bearing_deviation(lamp: LampPosition) -> float:
    """Return the standard deviation of a lamp's bearing [rad]."""
    squared = lamp.x * lamp.x + lamp.y * lamp.y
    if squared <= 0.0:
        return math.pi
    xx, xy, yy = lamp.spread
    x, y = lamp.x, lamp.y
    # Variance along and across the ray: quadratic forms with its unit vectors
    along = (x * x * xx + 2.0 * x * y * xy + y * y * yy) / squared
    across = (y * y * xx - 2.0 * x * y * xy + x * x * yy) / squared
    return math.sqrt(max(across, 0.0) / (squared + max(along, 0.0)))


def facing_strength(axes: tuple[tuple[float, float], ...], amplitudes: tuple[float, ...]) -> float:
    """Return the amplitude of a diode that would face the lamp [ADC counts]."""
    forward = left = 0.0
    for k in range(len(axes)):  # numba does not compile a strict zip
        forward += amplitudes[k] * axes[k][0]
        left += amplitudes[k] * axes[k][1]
    # Inverse of |sum M_i n_i| = N M / 4
    return 4.0 * math.hypot(forward, left) / max(len(axes), 1)


TRUSTED = 0.05  # rad: a lamp partly hidden by the hull is reported with a larger deviation
NEAREST_SIGHTING = 0.3  # m


class LampSighting(NamedTuple):
    """A lamp as one light block shows it."""

    # In the body frame, and its standard deviation [rad]
    bearing: float
    deviation: float
    # Rough distance [m], and its relative standard deviation
    distance: float
    spread: float
    strength: float  # amplitude of a diode that would face the lamp [ADC counts]
    frequency: float  # which tells lamps apart [Hz]
    age: float  # time since the middle of the block [s]


def build_sighting(
    lamp: LampPosition | None,
    axes: tuple[tuple[float, float], ...],
    amplitudes: tuple[float, ...],
    frequencies: tuple[float, ...],
    age: float,
) -> LampSighting | None:
    """
    Return the sighting of one block; None where no lamp is seen well.

    `lamp` is its estimate in the body frame; the tuples have one item per diode. `age` is the time
    since the middle of the block [s].
    """
    if lamp is None or not amplitudes or len(frequencies) != len(amplitudes):
        return None
    distance, deviation = math.hypot(lamp.x, lamp.y), bearing_deviation(lamp)
    finite = tuple([a if math.isfinite(a) else 0.0 for a in amplitudes])
    strength = facing_strength(axes, finite)
    frequency = frequencies[finite.index(max(finite))]
    # NaN compares false
    if not (
        deviation <= TRUSTED and distance > NEAREST_SIGHTING and strength > 0.0 and frequency > 0.0
    ):
        return None
    xx, xy, yy = lamp.spread
    x, y = lamp.x / distance, lamp.y / distance
    along = max(x * x * xx + 2.0 * x * y * xy + y * y * yy, 0.0)
    return LampSighting(
        math.atan2(lamp.y, lamp.x),
        deviation,
        distance,
        math.sqrt(along) / distance,
        strength,
        frequency,
        age,
    )
