"""Estimate sensor noise from third differences, in which smooth motion nearly vanishes."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HALF: Final = 0.6745  # median of the absolute value of white noise, in standard deviations
# Smallest credible noise by channel: m, rad, rad/s, m/s2, m, Pa.
LEAST: Final = np.array([5e-4] * 3 + [1e-3] * 3 + [3e-4] * 3 + [3e-3] * 3 + [1e-3, 0.3])


def estimate_noise(values: Array) -> float:
    """
    Estimate the standard deviation of white noise on an evenly sampled, smooth series.

    Uses the median size of third differences, which is robust to jumps and outliers. Ignores NaN.
    """
    third = np.diff(np.where(np.isfinite(values), values, np.nan), n=3)
    third = third[np.isfinite(third)]
    if len(third) < 8:
        return np.inf
    # 20 = 1 + 9 + 9 + 1: the variance of a third difference of unit white noise.
    return float(np.median(np.abs(third)) / HALF / np.sqrt(20.0))


def estimate_pose_noise(poses: Array) -> Array:
    """
    Estimate the white noise of a tracker's position and rotation vector, shape (6,). [m, rad]

    Outliers are told by it. A fit learns the noise, and what is slow in it, by itself. `poses`,
    shape (n, 7): position [m] and quaternion x y z w, of one sign.
    """
    own = np.array([estimate_noise(column) for column in poses.T])
    # A small rotation is twice the vector part of its quaternion; 4 components have 3 freedoms.
    turning = np.full(3, 2.0 * np.sqrt(np.mean(own[3:7] ** 2) * 4.0 / 3.0))
    levels: Array = np.maximum(np.concatenate([own[:3], turning]), LEAST[:6])
    return levels
