# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate sensor noise from third differences, in which smooth motion nearly vanishes.

Tracker outliers, up to three successive poses far off their neighbours, are told here too: on the
recorded poses, as resampling (`measured_flight`) would spread a wrong one.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

Array = NDArray[np.float64]

NOISE_MEDIAN: Final = 0.6745  # median of the absolute value of white noise, in standard deviations
# Smallest credible noise by channel: m, rad, rad/s, m/s2, m, Pa.
LEAST_NOISE: Final = np.array([5e-4] * 3 + [1e-3] * 3 + [3e-4] * 3 + [3e-3] * 3 + [1e-3, 0.3])
POSES_AROUND: Final = 7  # poses; width of the median filter
OUTLIER: Final = 12.0  # times the median distance from the filter, which is noise
# m, or quaternion component; a fast turn reaches less between few poses
LEAST_OUTLIER: Final = 0.02


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
    return float(np.median(np.abs(third)) / NOISE_MEDIAN / np.sqrt(20.0))


def estimate_pose_noise(poses: Array) -> Array:
    """
    Estimate the white noise of a tracker's position and rotation vector, shape (6,) [m, rad].

    Outliers are told by it. A fit learns the noise, and what is slow in it, by itself. `poses`,
    shape (n, 7): position [m] and quaternion x y z w, of one sign.
    """
    own = np.array([estimate_noise(column) for column in poses.T])
    # A small rotation is twice the vector part of its quaternion; 4 components have 3 freedoms.
    turning = np.full(3, 2.0 * np.sqrt(np.mean(own[3:7] ** 2) * 4.0 / 3.0))
    levels: Array = np.maximum(np.concatenate([own[:3], turning]), LEAST_NOISE[:6])
    return levels


def find_tracker_outliers(poses: Array) -> NDArray[np.bool_]:
    """
    Return a mask of the poses that are outliers (Hampel filter).

    The median follows motion, also across a gap: only an excursion of up to three poses is marked.

    `poses`, shape (n, 7): position [m] and quaternion, without sign changes.
    """
    valid = np.isfinite(poses).all(axis=1)
    out = np.zeros(len(poses), dtype=np.bool_)
    if valid.sum() < 2 * POSES_AROUND:
        return out
    whole = poses[valid]
    off = np.abs(whole - median_filter(whole, size=(POSES_AROUND, 1), mode='nearest'))
    usual = np.median(off, axis=0) / NOISE_MEDIAN
    out[valid] = (off > np.maximum(OUTLIER * usual, LEAST_OUTLIER)).any(axis=1)
    return out
