"""
Cut a flight into pieces of some seconds, each with its initial state.

In open loop a slightly wrong model diverges within a minute; in short pieces the error stays where
it arises.
"""

from dataclasses import dataclass
from typing import Final, final

from lta_discovery.flights.measured_flight import MeasuredFlight, PERIOD
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_exponential,
    quaternion_logarithm,
    quaternion_product,
    rotate_vectors,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LENGTH: Final = 6.0  # s
AROUND: Final = 0.5  # s; on either side of an initial state, for its estimate
ENOUGH: Final = 0.6  # of the poses around an initial state have to be known
SHORTEST: Final = 1.0  # s
FEWEST: Final = 2  # pieces of a flight, unless it is shorter than a piece
KNOTS: Final = 9  # of a piece, unless the motion of the vehicle requires more


@final
@dataclass(frozen=True, slots=True)
class Windows:
    """Pieces of a flight, all of n grid periods."""

    first: NDArray[np.int64]  # grid point of each beginning, shape (S,)
    length: int  # n; a piece has n + 1 states
    start: Array  # initial states, from the poses around them, shape (S, 13)
    # Points that belong to the piece: the last piece of a run may be shorter, shape (S, n)
    inside: NDArray[np.bool_]
    # Of the latent wrench of a piece, evenly spaced from its beginning to its end
    knots: int = KNOTS


def find_usable_runs(usable: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the runs of usable points as (first, end)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], usable.astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def fit_state_at(flight: MeasuredFlight, index: int, shift: float = 0.0) -> Array | None:
    """
    Estimate the state at a grid point by a cubic fit to the poses around it.

    Parameters
    ----------
    shift : float
        Time by which a pose is newer than its stamp. [s]

    Returns
    -------
    ndarray, shape (13,), or None
        Position, quaternion, body velocity and rates; None with too few known poses.

    """
    reach = round(AROUND / PERIOD)
    low, high = max(0, index - reach), min(len(flight.time), index + reach + 1)
    position, quaternion = flight.position[low:high], flight.quaternion[low:high]
    good = np.isfinite(position).all(axis=1) & np.isfinite(quaternion).all(axis=1)
    if good.sum() < ENOUGH * (2 * reach + 1):
        return None
    offset = (flight.time[low:high] - flight.time[index])[good] + shift
    # Rotations are taken about the nearest pose, so that they are small
    middle = quaternion[good][np.argmin(np.abs(offset))]
    turn = quaternion_logarithm(quaternion_product(quaternion_conjugate(middle), quaternion[good]))
    # Scaled time keeps the cubic well conditioned; constant term first
    powers = np.vander(offset / AROUND, 4, increasing=True)
    fit = np.linalg.lstsq(powers, np.hstack([position[good], turn]), rcond=None)[0]
    here = quaternion_product(middle, quaternion_exponential(fit[0, 3:]))
    velocity = rotate_vectors(quaternion_conjugate(here), fit[1, :3] / AROUND)
    # The rate of a small rotation vector is the body rate to second order in its size.
    return np.concatenate([fit[0, :3], here, velocity, fit[1, 3:] / AROUND])


def _piece_spacing(stretches: list[tuple[int, int]], count: int, shortest: int) -> int:
    """Return the spacing of pieces in grid points: their length, or less in a short flight."""
    if sum(len(range(begin, end - shortest, count)) for begin, end in stretches) >= FEWEST:
        return count
    longest = max((end - begin for begin, end in stretches), default=0)
    # Halves of a shorter run could not test a forecast over 3 s
    if longest < count:
        return count
    # Shorten the pieces, so that the longest run holds FEWEST of them
    return max(shortest + 1, min(count, -(-longest // FEWEST)))


def cut_into_pieces(
    flight: MeasuredFlight,
    length: float = LENGTH,
    shift: float = 0.0,
    knots: int = KNOTS,
    overlaps: int = 1,
) -> Windows:
    """
    Cut a flight into pieces; a flight too short for two full pieces gets two shorter ones.

    Parameters
    ----------
    overlaps : int
        Number of pieces that a point belongs to.

    """
    count, shortest = round(length / PERIOD), round(SHORTEST / PERIOD)
    first, start, inside = [], [], []
    runs = find_usable_runs(flight.usable)
    apart = _piece_spacing(runs, count, shortest)
    for begin, end in runs:
        for index in range(begin, end - shortest, max(apart // overlaps, 1)):
            state = fit_state_at(flight, index, shift)
            if state is not None:
                first.append(index)
                start.append(state)
                # The end of the piece, of the run, or of the flight
                last = min(index + apart, min(end, len(flight.time)) - 1)
                inside.append(np.arange(index, index + count) < last)
    return Windows(
        np.array(first, dtype=np.int64),
        count,
        np.array(start).reshape(-1, 13),
        np.array(inside, dtype=np.bool_).reshape(-1, count),
        knots,
    )
