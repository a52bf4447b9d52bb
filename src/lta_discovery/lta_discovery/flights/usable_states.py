"""Find the usable runs of a flight, and its state at a point from the poses around it."""

from typing import Final

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

SHORTEST_RUN: Final = 25  # grid points, one second; the motion of less is not studied
AROUND: Final = 0.5  # s; on either side of a state, for its estimate
ENOUGH: Final = 0.6  # of the poses around a state have to be known


def find_marked_runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the runs of marked points as (first, end)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
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
