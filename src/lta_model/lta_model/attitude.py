"""Convert attitudes to Euler angles and back."""

from typing import NamedTuple
import warnings

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation


class EulerAngles(NamedTuple):
    """Yaw in (-pi, pi], pitch in [-pi/2, pi/2] and roll in (-pi, pi], each of shape (n,). [rad]"""

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
    given = np.asarray(quaternions, dtype=np.float64).reshape(-1, 4)
    result = np.full((len(given), 3), np.nan)
    length = np.linalg.norm(given, axis=1)
    usable = np.isfinite(length) & (length > 0.0)
    if usable.any():
        with warnings.catch_warnings(action='ignore'):  # gimbal lock: roll is 0, yaw the rest
            # Upper case: intrinsic rotations, each about the axis already turned
            result[usable] = Rotation.from_quat(given[usable]).as_euler('ZYX')
    return EulerAngles(*result.T)


def to_quaternions(angles: EulerAngles) -> NDArray[np.float64]:
    """Return the quaternions x, y, z, w of angles, shape (n, 4): see `to_euler_angles`."""
    return Rotation.from_euler('ZYX', np.stack(angles, axis=1)).as_quat()
