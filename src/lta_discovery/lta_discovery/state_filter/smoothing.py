"""
Smooth a linearized flight: the most probable states and unexplained wrench, by all readings.

The backward pass is that of Bryson and Frazier, which inverts no covariance of states (Bierman,
Factorization methods for discrete sequential estimation, 1977, chapter X).
"""

from typing import Final, final, NamedTuple

from lta_discovery.replay.variational_equation import apply_state_changes
from lta_discovery.state_filter.kalman import AXES, BODY, describe_noise, PRESSURE, SIZE
from lta_discovery.state_filter.linear_flight import LinearFlight, POSE
from lta_discovery.state_filter.noise_model import NoiseModel
from numba import njit
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WRENCH: Final = slice(BODY, BODY + AXES)


@final
class SmoothedFlight(NamedTuple):
    """Most probable motion and unexplained wrench at each grid point; NaN outside of the runs."""

    motion: Array  # of the body in the map, shape (n, 13)
    wrench: Array  # on the body axes, shape (n, 6) [N, N m]
    deviation: Array  # standard deviation of the wrench, shape (n, 6)


def smooth_flight(flight: LinearFlight, noise: NoiseModel, values: Array) -> SmoothedFlight:
    """
    Smooth a flight with given parameters.

    `values`: relative to those about which the flight is linearized, shape (K,).
    """
    first, added, fading = describe_noise(noise)
    defect = flight.defect + flight.moved @ values
    left = flight.left - flight.read_moved @ values
    states = np.full((len(flight.motion), SIZE), np.nan)
    spread = np.full((len(flight.motion), AXES), np.nan)
    for (begin, end), begun in zip(flight.runs, flight.begun @ values, strict=True):
        _smooth_run(
            flight.step, flight.push, defect, left, flight.read, flight.felt, flight.count,
            begun, begin, end, first, added, fading, noise.white**2, states, spread,
        )  # fmt: skip
    motion = apply_state_changes(flight.motion, states[:, :BODY])
    return SmoothedFlight(motion, states[:, WRENCH], np.sqrt(spread))


@njit(error_model='numpy', cache=True, nogil=True)
def _smooth_run(
    step: Array,
    push: Array,
    defect: Array,
    left: Array,
    read: Array,
    felt: Array,
    count: Array,
    begun: Array,
    begin: int,
    end: int,
    first: Array,
    added: Array,
    fading: Array,
    white: Array,
    states: Array,
    spread: Array,
) -> None:
    """Smooth the grid points from `begin` to `end`; the last two arrays are written."""
    size, channels, n = len(first), left.shape[1], end - begin
    x, s = np.zeros((n, size)), np.zeros((n, size, size))
    # Of the readings of each point: information, pull, and what an update leaves of a change
    tells = np.zeros((n, size, size))
    pulls, leaves = np.zeros((n, size)), np.zeros((n, size, size))
    f, h = np.diag(fading), np.zeros((channels, size))
    ahead, wide = np.zeros(size), np.diag(first)
    ahead[:BODY] = begun
    for k in range(n):
        at, m = begin + k, 0
        v, e = np.zeros((channels, channels)), np.zeros(channels)
        for c in range(channels):
            if np.isfinite(left[at, c]) and (c >= POSE or count[at] > 0.0):
                h[m] = 0.0
                h[m, :BODY] = read[at, c]
                h[m, BODY : BODY + AXES] = felt[at, c]
                if c < POSE:
                    h[m, BODY + AXES + c] = 1.0
                elif c == PRESSURE:
                    h[m, size - 1] = 1.0
                v[m, m] = white[c] / count[at] if c < POSE else white[c]
                e[m] = left[at, c]
                m += 1
        x[k], s[k] = ahead, wide
        leaves[k] = np.eye(size)
        if m > 0:
            cross = wide @ h[:m].T
            both = np.linalg.solve(h[:m] @ cross + v[:m, :m], h[:m])
            off = e[:m] - h[:m] @ ahead
            pulls[k], tells[k] = both.T @ off, h[:m].T @ both
            leaves[k] -= wide @ tells[k]
            x[k] += wide @ pulls[k]
            s[k] -= wide @ tells[k] @ wide
        f[:BODY, :BODY] = step[at]
        f[:BODY, BODY : BODY + AXES] = push[at]
        ahead = f @ x[k]
        ahead[:BODY] += defect[at]
        wide = f @ s[k] @ f.T
        for i in range(size):
            wide[i, i] += added[i]
    pull, tell = np.zeros(size), np.zeros((size, size))
    for k in range(n - 1, -1, -1):
        at = begin + k
        states[at] = x[k] + s[k] @ pull
        for i in range(AXES):
            row = s[k, BODY + i]
            spread[at, i] = row[BODY + i] - row @ tell @ row
        # Back over the readings of this point, and the step to it
        pull = pulls[k] + leaves[k].T @ pull
        tell = tells[k] + leaves[k].T @ tell @ leaves[k]
        if k > 0:
            f[:BODY, :BODY] = step[at - 1]
            f[:BODY, BODY : BODY + AXES] = push[at - 1]
            pull = f.T @ pull
            tell = f.T @ tell @ f
