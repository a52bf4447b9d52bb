"""
Build an evenly spaced time grid over a recording, if its length is reasonable.

A computer that sets its clock while recording, by hours or from 1970 to today, creates stamps
that span years: a 100 Hz grid over them would not fit into memory.
"""

from lta_config.limits import GRID
import numpy as np
from numpy.typing import NDArray

EMPTY = np.empty(0)
HOLES = 3.0  # grid points per sample, at most; more would be mostly gaps


def is_grid_allowed(points: float, samples: int, most: float = HOLES) -> bool:
    """Return whether a grid over so many samples may have so many points."""
    # Short grids are always allowed, however sparse.
    return points <= max(GRID, most * samples)


def build_uniform_time_grid(
    first: float, last: float, step: float, samples: int
) -> NDArray[np.float64]:
    """Return an even grid over `samples` samples, empty if it would be too long. [s]"""
    return (
        np.arange(first, last, step) if is_grid_allowed((last - first) / step, samples) else EMPTY
    )
