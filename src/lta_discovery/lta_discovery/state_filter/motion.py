# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Measured motion of a flight at each grid point, about which the model is linearized.

States are polynomials through the poses around a point. They need not be accurate: a filter that
is linear about them estimates how far off they are.
"""

from typing import Final

from lta_data import even_grid
from lta_discovery.flights.measured_flight import GRID_PERIOD, MeasuredFlight, SHORTEST_RUN
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

# Grid periods of poses on a side, and degree of the polynomial: through poses on both sides, short
# enough for a swing, and through past ones alone, where a cubic would amplify noise
REACHES: Final = {True: 6, False: 12}
FIT_ORDERS: Final = {True: 3, False: 2}
LEAST_SHARE: Final = 0.6  # of the poses of a window have to be known
CHUNK: Final = 2000  # grid points at a time, to limit memory


def fit_motion(flight: MeasuredFlight, with_future: bool = True) -> Array:
    """
    Return position, quaternion, body velocity and rates at each grid point, shape (n, 13).

    Of the markers, in the tracker's frame; NaN where too few poses are known. [m, m/s, rad/s]

    `with_future`: whether poses after a point count, too.
    """
    reach = REACHES[with_future]
    offsets = np.arange(-reach, reach + 1 if with_future else 1)
    powers = np.vander(offsets * GRID_PERIOD, FIT_ORDERS[with_future] + 1, increasing=True).astype(
        float
    )
    out = np.full((len(flight.time), 13), np.nan)
    for begin in range(0, len(out), CHUNK):
        rows = np.arange(begin, min(begin + CHUNK, len(out)))
        out[rows] = _fit_points(flight, rows, offsets, powers)
    return out


def _fit_points(
    flight: MeasuredFlight, rows: NDArray[np.int64], offsets: NDArray[np.int64], powers: Array
) -> Array:
    """Return the states of some grid points."""
    index = rows[:, None] + offsets
    inside = (index >= 0) & (index < len(flight.time))
    index = np.clip(index, 0, len(flight.time) - 1)
    position, quaternion = flight.position[index], flight.quaternion[index]
    measured = inside & np.isfinite(position).all(-1) & np.isfinite(quaternion).all(-1)
    # Rotations are taken about the nearest known pose, so that they are small
    nearest = np.argmin(np.where(measured, np.abs(offsets), len(offsets)), axis=1)
    middle = np.take_along_axis(quaternion, nearest[:, None, None], axis=1)
    away = np.broadcast_to(quaternion_conjugate(middle), quaternion.shape)
    turn = quaternion_logarithm(quaternion_product(away, quaternion))
    weights = measured[..., None].astype(np.float64)
    table = np.where(measured[..., None], np.concatenate([position, turn], axis=-1), 0.0)
    normal = np.einsum('so,op,oq->spq', weights[..., 0], powers, powers)
    enough = measured.sum(axis=1) >= LEAST_SHARE * len(offsets)
    normal[~enough] = np.eye(powers.shape[1])
    fit = np.linalg.solve(normal, np.einsum('op,soc->spc', powers, table))
    here = quaternion_product(middle[:, 0], quaternion_exponential(fit[:, 0, 3:]))
    velocity = rotate_vectors(quaternion_conjugate(here), fit[:, 1, :3])
    out = np.concatenate([fit[:, 0, :3], here, velocity, fit[:, 1, 3:]], axis=1)
    out[~enough] = np.nan
    return out


def find_runs(flight: MeasuredFlight, motion: Array) -> list[tuple[int, int]]:
    """Return the runs of grid points, as (first, end), in which the motion is known."""
    measured = np.isfinite(motion).all(axis=1) & flight.usable
    return [(a, b) for a, b in even_grid.find_runs(measured).tolist() if b - a >= SHORTEST_RUN]


def collect_readings(flight: MeasuredFlight, motion: Array) -> tuple[Array, Array]:
    """
    Return the pose that was read in each grid period, and how many poses that is.

    A pose counts at the nearest grid point, moved there with the measured velocity; several are
    averaged. Repeated poses are no readings. Position and quaternion, shape (n, 7), NaN without
    a reading; number of poses, shape (n,).

    `motion`: as from `fit_motion`.
    """
    poses = flight.poses
    if poses is None:
        both = np.column_stack([flight.position, flight.quaternion])
        return both, np.asarray(np.isfinite(both).all(axis=1), dtype=np.float64)
    time, values = poses.time, poses.values
    new = np.concatenate([[True], np.any(np.diff(values, axis=0) != 0.0, axis=1)])
    good = new & np.isfinite(values).all(axis=1)
    at = np.rint((time - flight.time[0]) / GRID_PERIOD).astype(np.int64)
    good &= (at >= 0) & (at < len(flight.time))
    time, values, at = time[good], values[good], at[good]
    # Pose and known motion at the grid point
    here = motion[at]
    good = np.isfinite(here).all(axis=1) & np.isfinite(flight.position[at]).all(axis=1)
    time, values, at, here = time[good], values[good], at[good], here[good]
    late = (time - flight.time[at])[:, None]
    place = values[:, :3] - late * rotate_vectors(here[:, 3:7], here[:, 7:10])
    turned = quaternion_product(values[:, 3:7], quaternion_exponential(-late * here[:, 10:13]))
    turn = quaternion_logarithm(quaternion_product(quaternion_conjugate(here[:, 3:7]), turned))
    count = np.bincount(at, minlength=len(flight.time)).astype(np.float64)
    total = np.zeros((len(flight.time), 6))
    np.add.at(total, at, np.concatenate([place, turn], axis=1))
    out = np.full((len(flight.time), 7), np.nan)
    read = count > 0
    mean = total[read] / count[read, None]
    out[read, :3] = mean[:, :3]
    out[read, 3:] = quaternion_product(motion[read, 3:7], quaternion_exponential(mean[:, 3:]))
    return out, count
