"""
Poses that a tracker mistook: one, two or three in a row that lie far off those around them.

Looked for among the poses as recorded, before they are put on the grid (`measured`): interpolation
would spread a wrong pose over its neighbours. What is wild on the grid, and single readings of the
sensors, is told by `outliers`.
"""

from typing import Final

from lta_discovery.flights.noise import HALF
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

Array = NDArray[np.float64]

AROUND: Final = 7  # poses; the middle one of so many is where a tracker that is right would be
CLEAR: Final = 12.0  # times the usual distance from there, which is noise
LEAST: Final = 0.02  # m, or of a quaternion; what a fast turn comes to between few poses


def find_tracker_outliers(poses: Array) -> NDArray[np.bool_]:
    """
    Tell which poses lie far off those around them (Hampel's rule).

    Motion takes the middle pose along, also over a gap, so that only what goes there and back
    within three poses is told.

    Parameters
    ----------
    poses : ndarray, shape (n, 7)
        Position [m] and quaternion, which does not change its sign.

    Returns
    -------
    ndarray of bool, shape (n,)
        True where any number is off.

    """
    known = np.isfinite(poses).all(axis=1)
    out = np.zeros(len(poses), dtype=np.bool_)
    if known.sum() < 2 * AROUND:
        return out
    whole = poses[known]
    off = np.abs(whole - median_filter(whole, size=(AROUND, 1), mode='nearest'))
    usual = np.median(off, axis=0) / HALF
    out[known] = (off > np.maximum(CLEAR * usual, LEAST)).any(axis=1)
    return out
