"""
Compute a damped Newton step within bounds (Levenberg 1944, Marquardt 1963).

With many similar parameters, a full Gauss-Newton step leaves the region where the slopes are
valid. Damping shortens the step where information is low. A parameter that is pushed against its
bound is fixed there, so that the others do not rely on it.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

START: Final = 2e-3  # of the information
LEAST: Final = 1e-5  # of the information; smaller damping has no effect
LESS: Final = 0.2  # times the damping, after a successful step
MORE: Final = 5.0  # times the damping, after a failed step
TRIES: Final = 6  # trial steps, ever shorter


def next_damping(damping: float, better: bool) -> float:
    """Return the damping after a successful or failed step."""
    return max(damping * LESS, LEAST) if better else damping * MORE


def solve_bounded_step(inner: Array, right: Array, at: Array, low: Array, high: Array) -> Array:
    """Return the result of a Newton step within bounds."""
    free = np.ones(len(at), dtype=np.bool_)
    step = np.zeros(len(at))
    # Active set: fix the parameters that push against a bound, and solve for the rest again.
    while free.any():
        step[:] = 0.0
        step[free] = np.linalg.solve(inner[np.ix_(free, free)], right[free])
        # At a bound, and the step points outwards
        against = ((at <= low) & (step < 0.0)) | ((at >= high) & (step > 0.0))
        if not (against & free).any():
            break
        free &= ~against
    else:
        step[:] = 0.0
    bounded: Array = np.clip(at + step, low, high)
    return bounded
