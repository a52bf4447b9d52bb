"""Find runs of samples that fulfil a condition, and the resolution that makes equal ones usual."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

SAME = 1e-9  # of the range of a channel; smaller changes are rounding errors of a computer
NEAR = 0.05  # of a unit of the resolution
COARSE = 2.0  # units; readings that change less at random follow each other predictably


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


def find_coarse_unit(values: NDArray[np.float64]) -> float:
    """
    Return the unit to which readings are rounded, if that hides their noise; 0 otherwise.

    Rounded readings of a smooth motion repeat, rest at extremes and come again, by no fault.
    """
    values = values[np.isfinite(values)]
    steps = np.abs(np.diff(values))
    moving = steps[steps > SAME * np.ptp(values)] if len(values) else steps
    if not len(moving):
        return 0.0
    units = moving / moving.min()
    on_scale = np.percentile(np.abs(units - np.round(units)), 98.0) < NEAR
    noise = float(np.median(np.abs(np.diff(values, 2))))
    return float(moving.min()) if on_scale and noise < COARSE * moving.min() else 0.0
