"""How much of a recorded series is noise: from its third differences, which motion hardly has."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HALF: Final = 0.6745  # median of the size of white noise, in its deviations
# What no sensor is better than, by channel: m, rad, rad/s, m/s2, m, Pa.
LEAST: Final = np.array([5e-4] * 3 + [1e-3] * 3 + [3e-4] * 3 + [3e-3] * 3 + [1e-3, 0.3])
# A tracker whose noise seems smaller by that factor was filtered: what the filter did to motion
# is then its error (assumed: 8 mm, 0.9 degrees), and the poses of half a second say the same.
FILTERED: Final = 0.2
SMOOTH: Final = 16.0  # of LEAST
ALIKE: Final = 12.5  # poses


def estimate_noise(values: Array) -> float:
    """
    Return the standard deviation of white noise on a smooth series, from its third differences.

    By the median of their sizes, so that jumps and outliers count little; NaN-safe.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Evenly sampled.

    """
    third = np.diff(np.where(np.isfinite(values), values, np.nan), n=3)
    third = third[np.isfinite(third)]
    if len(third) < 8:
        return np.inf
    return float(np.median(np.abs(third)) / HALF / np.sqrt(20.0))


def estimate_pose_noise(poses: Array) -> tuple[Array, float]:
    """
    Return the noise of a tracker, and how many of its poses say the same.

    Parameters
    ----------
    poses : ndarray, shape (n, 7)
        Position [m] and quaternion x y z w, of one sign.

    Returns
    -------
    ndarray, shape (6,), and float
        Of place and rotation vector [m, rad], as large as each pose counts; 1.0 where poses are
        independent.

    """
    own = np.array([estimate_noise(column) for column in poses.T])
    turning = np.full(3, 2.0 * np.sqrt(np.mean(own[3:7] ** 2) * 4.0 / 3.0))
    levels = np.maximum(np.concatenate([own[:3], turning]), LEAST[:6])
    if np.median(own[:3] / LEAST[:3]) >= FILTERED:
        return levels, 1.0
    return np.maximum(levels, SMOOTH * LEAST[:6]) * np.sqrt(ALIKE), ALIKE
