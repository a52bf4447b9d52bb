"""Estimate sensor noise from third differences, in which smooth motion nearly vanishes."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HALF: Final = 0.6745  # median of the absolute value of white noise, in standard deviations
# Smallest credible noise by channel: m, rad, rad/s, m/s2, m, Pa.
LEAST: Final = np.array([5e-4] * 3 + [1e-3] * 3 + [3e-4] * 3 + [3e-3] * 3 + [1e-3, 0.3])
# A tracker with noise below this factor was filtered. Its error is then what the filter did to
# motion (assumed: 8 mm, 0.9 degrees), and is correlated over half a second.
FILTERED: Final = 0.2
SMOOTH: Final = 16.0  # of LEAST
ALIKE: Final = 12.5  # poses


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


def estimate_pose_noise(poses: Array) -> tuple[Array, float]:
    """
    Estimate the noise of a tracker, and the number of poses with correlated errors.

    Parameters
    ----------
    poses : ndarray, shape (n, 7)
        Position [m] and quaternion x y z w, of one sign.

    Returns
    -------
    ndarray, shape (6,), and float
        Of position and rotation vector [m, rad], scaled by the root of the number; 1.0 for
        independent poses.

    """
    own = np.array([estimate_noise(column) for column in poses.T])
    # A small rotation is twice the vector part of its quaternion; 4 components have 3 freedoms.
    turning = np.full(3, 2.0 * np.sqrt(np.mean(own[3:7] ** 2) * 4.0 / 3.0))
    levels = np.maximum(np.concatenate([own[:3], turning]), LEAST[:6])
    # An unfiltered tracker: white noise, independent from pose to pose
    if np.median(own[:3] / LEAST[:3]) >= FILTERED:
        return levels, 1.0
    return np.maximum(levels, SMOOTH * LEAST[:6]) * np.sqrt(ALIKE), ALIKE
