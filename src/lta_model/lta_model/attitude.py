# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Convert attitudes to Euler angles and back."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

# rad from straight up or down: only the sum or difference of yaw and roll is known
GIMBAL_LOCK = 1e-7
# numpy's own arctan2 differs in the last bit from processor to processor
_atan2 = np.frompyfunc(math.atan2, 2, 1)


class EulerAngles(NamedTuple):
    """Yaw in (-pi, pi], pitch in [-pi/2, pi/2] and roll in (-pi, pi], each of shape (n,) [rad]."""

    yaw: NDArray[np.float64]
    pitch: NDArray[np.float64]
    roll: NDArray[np.float64]


def to_euler_angles(quaternions: ArrayLike) -> EulerAngles:
    """
    Return yaw, pitch and roll: intrinsic rotations about z, then y, then x.

    `quaternions` are body to world as x, y, z, w, shape (n, 4), of any length. A zero quaternion,
    which ROS leaves in an unset message, gives NaN. REP-103: with z up and x forward, positive
    pitch is nose down.
    """
    rows = np.asarray(quaternions, dtype=np.float64).reshape(-1, 4)
    length = np.linalg.norm(rows, axis=1)
    length[~np.isfinite(length) | (length == 0.0)] = np.nan
    x, y, z, w = rows.T / length
    # Bernardes and Viollet (2022), https://doi.org/10.1371/journal.pone.0276302, as scipy has it:
    # importing scipy takes longer than a page
    half_sum = _atan2(x + z, w - y).astype(np.float64)
    half_difference = _atan2(z - x, w + y).astype(np.float64)
    from_top = 2.0 * _atan2(np.hypot(y + w, z - x), np.hypot(w - y, x + z)).astype(np.float64)
    up, down = from_top <= GIMBAL_LOCK, np.abs(from_top - np.pi) <= GIMBAL_LOCK
    yaw = np.where(up, 2.0 * half_sum, half_sum + half_difference)
    yaw = np.where(down, 2.0 * half_difference, yaw)
    roll = np.where(up | down, 0.0, half_sum - half_difference)
    return EulerAngles(_wrap(yaw), from_top - np.pi / 2.0, _wrap(roll))


def _wrap(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return angles from -2 pi to 2 pi as angles from -pi to pi."""
    angle = np.where(angle < -np.pi, angle + 2.0 * np.pi, angle)
    return np.where(angle > np.pi, angle - 2.0 * np.pi, angle)


def to_quaternions(angles: EulerAngles) -> NDArray[np.float64]:
    """Return the quaternions x, y, z, w of angles, shape (n, 4): see `to_euler_angles`."""
    # Imported late: it takes a quarter of a second, and few pages need it
    from scipy.spatial.transform import Rotation

    return Rotation.from_euler('ZYX', np.stack(angles, axis=1)).as_quat()
