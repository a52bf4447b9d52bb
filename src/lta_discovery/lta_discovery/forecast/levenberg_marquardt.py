"""
A damped step within bounds, for a fit that is far from linear (Levenberg 1944, Marquardt 1963).

A full step of Gauss-Newton over many knobs that hardly differ leads out of where the slopes hold.
Damping in the metric of the information shortens the step where little is known; a knob that
rests on a bound and is pushed against it is held there, so that the others do not reckon with it.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

START: Final = 2e-3  # of the information
LEAST: Final = 1e-5  # of the information; below it a step is as good as undamped
LESS: Final = 0.2  # times the damping, after a step that helped
MORE: Final = 5.0  # times the damping, after one that did not
TRIES: Final = 6  # steps, ever shorter


def next_damping(damping: float, better: bool) -> float:
    """Return the damping after a step that made it better, or did not."""
    return max(damping * LESS, LEAST) if better else damping * MORE


def solve_bounded_step(inner: Array, right: Array, at: Array, low: Array, high: Array) -> Array:
    """
    Return where a step of Newton leads, within bounds.

    Parameters
    ----------
    inner, right : ndarray, shape (K, K) and (K,)
        Information, damped or not, and pull.
    at, low, high : ndarray, shape (K,)
        Where the knobs stand, and their bounds.

    """
    free = np.ones(len(at), dtype=np.bool_)
    step = np.zeros(len(at))
    while free.any():
        step[:] = 0.0
        step[free] = np.linalg.solve(inner[np.ix_(free, free)], right[free])
        against = ((at <= low) & (step < 0.0)) | ((at >= high) & (step > 0.0))
        if not (against & free).any():
            break
        free &= ~against
    else:
        step[:] = 0.0
    kept: Array = np.clip(at + step, low, high)
    return kept
