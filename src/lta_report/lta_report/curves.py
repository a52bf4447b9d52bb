# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Curves of a flight for figures, and their conversions.

Time is in seconds from the first message, positions are in the map frame.
"""

from typing import NamedTuple

from lta_model.attitude import to_euler_angles
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class MotionCurve(NamedTuple):
    """Hull centre in map [m], unwrapped yaw [rad], air-relative speed along body x [m/s]."""

    time: Array
    x: Array
    y: Array
    z: Array
    yaw: Array
    speed: Array


class TimeCurve(NamedTuple):
    """One quantity over time [s, its unit]."""

    time: Array
    value: Array


class DirectionCurve(NamedTuple):
    """A direction in the body frame over time; NaN if undefined [s, rad]."""

    time: Array
    angle: Array


class FloorPoint(NamedTuple):
    """A place on the floor plan [m, map]."""

    x: float
    y: float


class ElectricalCurve(NamedTuple):
    """Voltage [V] and current [A] over time; negative current discharges the battery."""

    time: Array
    voltage: Array
    current: Array


class PeakCurves(NamedTuple):
    """Readings of each diode over time [s], each of shape (n, diodes), by field."""

    time: Array
    fields: dict[str, Array]


class DutyCurves(NamedTuple):
    """Commanded duty of each rotor, shape (n, rotors) [1]."""

    time: Array
    names: list[str]
    values: Array


def interpolate(time: Array, track_time: Array, values: Array) -> Array:
    """Return linearly interpolated values at other times [s], constant beyond the ends."""
    return np.asarray(np.interp(time, track_time, values))


def hold_last(time: Array, track: TimeCurve) -> Array:
    """Return the last value at each time [s], as a set-point is held; NaN before the first."""
    # -1 before the first value
    index = np.searchsorted(track.time, time, side='right') - 1
    # The extra NaN is what times before the first value select
    values = np.append(track.value, np.nan)
    return np.asarray(values[np.where(index < 0, len(track.value), index)])


def build_motion(time: Array, place: Array, attitude: Array, speed: Array) -> MotionCurve:
    """Return a motion from positions, shape (n, 3), quaternions, shape (n, 4), and speeds."""
    x, y, z = place.T
    return MotionCurve(time, x, y, z, np.unwrap(to_euler_angles(attitude).yaw), speed)


def subtract_wind(motion: MotionCurve, time: Array, wind: Array) -> MotionCurve:
    """Return a motion with the wind, shape (n, 3) in map [m/s], subtracted from its speed."""
    # Component of the horizontal wind along the heading; pitch is neglected
    along = interpolate(motion.time, time, wind[:, 0]) * np.cos(motion.yaw)
    along += interpolate(motion.time, time, wind[:, 1]) * np.sin(motion.yaw)
    return motion._replace(speed=motion.speed - along)


def align_start(motion: MotionCurve, truth: MotionCurve) -> MotionCurve:
    """Return a motion rotated and shifted to start like the true one."""
    # Odometry has an arbitrary origin and heading, so compare shapes only
    turn = float(truth.yaw[0] - motion.yaw[0])
    x, y = motion.x - motion.x[0], motion.y - motion.y[0]
    return motion._replace(
        x=truth.x[0] + np.cos(turn) * x - np.sin(turn) * y,
        y=truth.y[0] + np.sin(turn) * x + np.cos(turn) * y,
        yaw=motion.yaw + turn,
    )


def vector_directions(vectors: Array) -> Array:
    """Return the directions of bearing vectors; NaN for a zero vector [rad]."""
    angle = np.arctan2(vectors[:, 1], vectors[:, 0])
    # The estimator publishes a zero vector if it has no bearing
    angle[np.hypot(vectors[:, 0], vectors[:, 1]) == 0.0] = np.nan
    return angle
