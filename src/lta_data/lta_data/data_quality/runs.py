"""Find runs of samples that fulfil a condition."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray


def find_runs(true: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return first and one-past-last index of each run of True, shape (n, 2)."""
    # False at both ends, so that runs there are closed as well.
    edges = np.flatnonzero(np.diff(np.concatenate(([False], true, [False])).astype(np.int8)))
    return edges.reshape(-1, 2)


def merge_runs(bounds: NDArray[np.int64], apart: int) -> Iterator[tuple[int, int]]:
    """Yield runs, merging those at most `apart` samples apart."""
    held: tuple[int, int] | None = None
    for begin, end in bounds.tolist():
        if held is not None and begin - held[1] <= apart:
            held = held[0], end
        else:
            if held is not None:
                yield held
            held = begin, end
    if held is not None:
        yield held
