"""Find the usable runs of a flight."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

SHORTEST_RUN: Final = 25  # grid points, one second; the motion of less is not studied


def find_marked_runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the runs of marked points as (first, end)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]
