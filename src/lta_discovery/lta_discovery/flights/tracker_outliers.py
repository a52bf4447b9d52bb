"""
Detect tracker outliers: up to three successive poses far off their neighbours.

This runs on the recorded poses, before they are resampled (`measured_flight`), because
interpolation would spread a wrong pose. `outliers` then treats the grid and the sensors.
"""

from typing import Final

from lta_discovery.flights.noise import HALF
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

Array = NDArray[np.float64]

AROUND: Final = 7  # poses; width of the median filter
CLEAR: Final = 12.0  # times the median distance from the filter, which is noise
LEAST: Final = 0.02  # m, or quaternion component; a fast turn reaches less between few poses


def find_tracker_outliers(poses: Array) -> NDArray[np.bool_]:
    """
    Return a mask of the poses that are outliers (Hampel filter).

    The median follows motion, also across a gap: only an excursion of up to three poses is marked.

    `poses`, shape (n, 7): position [m] and quaternion, without sign changes.
    """
    valid = np.isfinite(poses).all(axis=1)
    out = np.zeros(len(poses), dtype=np.bool_)
    if valid.sum() < 2 * AROUND:
        return out
    whole = poses[valid]
    off = np.abs(whole - median_filter(whole, size=(AROUND, 1), mode='nearest'))
    usual = np.median(off, axis=0) / HALF
    out[valid] = (off > np.maximum(CLEAR * usual, LEAST)).any(axis=1)
    return out
