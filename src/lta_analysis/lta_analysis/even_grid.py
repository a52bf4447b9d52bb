"""
An even clock over a recording, where its stamps allow one.

A computer that sets its clock while it records, from 1970 to today for example, makes stamps that
reach over decades: a clock of 100 Hz over these would be larger than any memory.
"""

from lta_config.limits import GRID
import numpy as np
from numpy.typing import NDArray

EMPTY = np.empty(0)


def fits(points: float, samples: int) -> bool:
    """Tell whether an even clock over so many samples may have so many points."""
    return bool(points <= max(GRID, samples))


def even_grid(time: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """
    Return an even clock from the first time to the last; empty where it would be too long.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Rising. [s]
    step : float
        [s]

    """
    if not len(time) or not fits((time[-1] - time[0]) / step, len(time)):
        return EMPTY
    return np.arange(time[0], time[-1], step)
