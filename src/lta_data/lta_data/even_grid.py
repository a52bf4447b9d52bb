"""
An even clock over a recording, where its stamps allow one.

A computer that sets its clock while it records, by hours or from 1970 to today, makes stamps that
reach far: a clock of 100 Hz over these could be larger than any memory.
"""

from lta_config.limits import GRID
import numpy as np
from numpy.typing import NDArray

EMPTY = np.empty(0)
HOLES = 3.0  # points to a sample, beyond which it is nearly all holes


def is_grid_allowed(points: float, samples: int, most: float = HOLES) -> bool:
    """Tell whether an even clock over so many samples may have so many points."""
    return points <= max(GRID, most * samples)


def build_even_grid(first: float, last: float, step: float, samples: int) -> NDArray[np.float64]:
    """
    Return an even clock; empty where it would be too long.

    Parameters
    ----------
    first, last, step : float
        [s]
    samples : int
        How many there are between the two.

    """
    return (
        np.arange(first, last, step) if is_grid_allowed((last - first) / step, samples) else EMPTY
    )
