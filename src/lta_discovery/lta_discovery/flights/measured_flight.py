# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Resample a measured flight to a common time grid.

Input: sensor streams with their own times. Output: pose, rates, specific force, range and pressure
on one grid, NaN where a channel has no reading, with the noise of each estimated from the data.
Commands keep their own times, because the model needs their onset to a few milliseconds.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Final, final

from lta_data.even_grid import check_time_span
from lta_data.interpretation.jumps import find_tracker_jumps
from lta_discovery.flights.noise import (
    estimate_noise,
    estimate_pose_noise,
    find_tracker_outliers,
    LEAST_NOISE,
)
from lta_discovery.model.quaternions import quaternion_product, rotate_vectors
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

GRID_PERIOD: Final = 0.04  # s; of the grid
WARM_UP: Final = 2.0  # s; filters and motors settle
MOTOR_WARM_UP: Final = 0.5  # s; the same for flights with a tracker only: motors settle
GAP: Final = 0.12  # s; longest gap of a tracker that is interpolated
SHORTEST_RUN: Final = 25  # grid points, one second; the motion of less is not studied
BRIDGED: Final = 0.5  # s; a shorter gap does not end a piece, but has no poses
ALL_CHANNELS: Final = (
    'x', 'y', 'z', 'turn_x', 'turn_y', 'turn_z', 'p', 'q', 'r', 'fx', 'fy', 'fz',
    'range', 'pressure',
)  # fmt: skip
FILTERS: Final = ('rates', 'force', 'range', 'pressure')  # sensors that settle


@final
@dataclass(frozen=True, slots=True)
class Stream:
    """Samples of one sensor, or of the commands."""

    time: Array  # since the start of the flight, rising, shape (n,) [s]
    values: Array  # NaN or infinite where a reading is invalid, shape (n, k)


@final
@dataclass(frozen=True, slots=True)
class FlightStreams:
    """All recorded streams of a flight."""

    pose: Stream  # position [m] and quaternion x y z w of the body in the map
    commands: Stream  # duty of each rotor, held until the next
    # Any of 'rates' [rad/s], 'force' [m/s2], 'range' [m], 'pressure' [Pa], 'voltage' [V]
    others: Mapping[str, Stream] = field(default_factory=dict)
    # Height of the hull centre below which the vehicle may touch the floor [m]
    floor: float = -np.inf
    # Commanded force and moment about the hull centre, body frame, held until the next; for
    # vehicles without duty commands [N, N m]
    wrench: Stream | None = None
    # Commanded place of the moving mass, body frame, held until the next [m]
    mass: Stream | None = None


@final
@dataclass(frozen=True, slots=True)
class MeasuredFlight:
    """A flight on a grid of n points."""

    time: Array  # shape (n,) [s]
    # NaN in gaps, shape (n, 3)
    position: Array
    quaternion: Array
    # Rates, specific force, range, pressure; the first two as means until the next point, shape
    # (n, 8)
    readings: Array
    noise: Array  # standard deviation by ALL_CHANNELS; infinite for an absent channel, shape (14,)
    usable: NDArray[np.bool_]  # whether the point is part of the fit, shape (n,)
    commands: Stream
    voltage: Array  # of the battery, NaN where it is unknown, shape (n,) [V]
    wrench: Stream | None = None
    mass: Stream | None = None
    # As recorded, without outliers: position and quaternion; None where the grid has one each
    poses: Stream | None = None

    @property
    def has_only_pose(self) -> bool:
        """Return whether only the pose was measured: no inertial unit, no other sensor."""
        return not np.isfinite(self.noise[6:]).any()

    def with_marker_frame(self, turn: Array, shift: Array) -> 'MeasuredFlight':
        """
        Return the flight as markers would show it that are turned and moved on the vehicle.

        `turn`: quaternion, applied to the attitude from the right. `shift`: of the origin, in the
        marker axes. [m]
        """
        poses = self.poses
        if poses is not None:
            moved = _move_markers(poses.values[:, :3], poses.values[:, 3:], turn, shift)
            poses = Stream(poses.time, np.column_stack(moved))
        position, quaternion = _move_markers(self.position, self.quaternion, turn, shift)
        return replace(self, position=position, quaternion=quaternion, poses=poses)


def _move_markers(
    position: Array, quaternion: Array, turn: Array, shift: Array
) -> tuple[Array, Array]:
    """Return positions and quaternions of other markers on the vehicle."""
    away = np.broadcast_to(shift, position.shape)
    return position + rotate_vectors(quaternion, away), quaternion_product(quaternion, turn)


def _median_interval(stream: Stream) -> float:
    """Return the median time between readings [s]."""
    return float(np.median(np.diff(stream.time)))


def _interpolate_stream(grid: Array, stream: Stream, gap: float) -> Array:
    """Interpolate linearly; NaN where the neighbouring readings are too far apart."""
    good = np.isfinite(stream.values).all(axis=1)
    time, values = stream.time[good], stream.values[good]
    if len(time) < 2:
        return np.full((len(grid), stream.values.shape[1]), np.nan)
    # Index of the reading after each grid point
    after = np.clip(np.searchsorted(time, grid), 1, len(time) - 1)
    out = np.column_stack([np.interp(grid, time, column) for column in values.T])
    outside = (grid < time[0] - 1e-9) | (grid > time[-1] + 1e-9)
    # Neither bridge long gaps nor extrapolate
    out[(time[after] - time[after - 1] > gap) | outside] = np.nan
    return out


def _align_signs(quaternions: Array) -> Array:
    """Remove sign changes between neighbours: q and -q are the same rotation."""
    dots = np.sum(quaternions[1:] * quaternions[:-1], axis=1)
    # q and -q are the same rotation; a flip would spoil the interpolation
    signs = np.concatenate([[1.0], np.cumprod(np.where(dots < 0.0, -1.0, 1.0))])
    same: Array = quaternions * signs[:, None]
    return same


def _average_periods(grid: Array, stream: Stream) -> Array:
    """Return the mean over each grid period of a series that is linear between readings."""
    apart = np.diff(stream.time)[:, None]
    # Trapezoidal rule; differences of the running integral give the means.
    pieces = 0.5 * (stream.values[1:] + stream.values[:-1]) * apart
    total = np.vstack([np.zeros((1, stream.values.shape[1])), np.cumsum(pieces, axis=0)])
    # The integral is parabolic between readings; linear is close, as the grid is near readings.
    at = np.column_stack([np.interp(grid, stream.time, column) for column in total.T])
    means = np.diff(at, axis=0) / np.diff(grid)[:, None]
    means[(grid[:-1] < stream.time[0]) | (grid[1:] > stream.time[-1])] = np.nan
    # The last point begins no period
    return np.vstack([means, np.full((1, means.shape[1]), np.nan)])


def _interpolate_slow_sensor(grid: Array, stream: Stream) -> Array:
    """Interpolate a slow sensor; one with a higher rate than the grid is not averaged."""
    return _interpolate_stream(grid, stream, 4.0 * _median_interval(stream))


def _resample_readings(grid: Array, others: Mapping[str, Stream]) -> tuple[Array, Array]:
    """Return rates, force, range, pressure on the grid, and their noise."""
    out, noise = np.full((len(grid), 8), np.nan), np.full(8, np.inf)
    for name, place, width in (
        ('rates', 0, 3),
        ('force', 3, 3),
        ('range', 6, 1),
        ('pressure', 7, 1),
    ):
        stream = others.get(name)
        # Too few readings for a noise estimate.
        if stream is None or len(stream.time) < 16:
            continue
        columns = slice(place, place + width)
        single = np.array([estimate_noise(column) for column in stream.values.T])
        if width == 3:
            out[:, columns] = _average_periods(grid, stream)
            # A mean over a grid period has the noise of one reading by the root of their number.
            noise[columns] = single * np.sqrt(min(1.0, _median_interval(stream) / GRID_PERIOD))
        else:
            out[:, columns] = _interpolate_slow_sensor(grid, stream)
            noise[columns] = single
    return out, noise


def _bridge_gaps(valid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mark known points, and gaps that are short enough to continue through."""
    out: NDArray[np.bool_] = valid.copy()
    # Begin and end of each invalid run; padding with 1 closes runs at both ends
    edges = np.flatnonzero(np.diff(np.concatenate([[1], valid.astype(np.int8), [1]])))
    for begin, end in edges.reshape(-1, 2):
        inside = begin > 0 and end < len(valid)
        if inside and (end - begin) * GRID_PERIOD <= BRIDGED:
            out[begin:end] = True
    return out


def resample_flight(streams: FlightStreams) -> MeasuredFlight:
    """
    Resample a flight to the grid, from the first pose to the last.

    Points are not usable while sensors and motors settle, in longer gaps of the tracker, and near
    the floor.
    """
    pose = Stream(
        streams.pose.time,
        np.column_stack([streams.pose.values[:, :3], _align_signs(streams.pose.values[:, 3:7])]),
    )
    wrong = find_tracker_outliers(pose.values)
    wrong |= find_tracker_jumps(pose.time, np.where(wrong[:, None], np.nan, pose.values))
    pose = Stream(pose.time[~wrong], pose.values[~wrong])
    # Grid points at multiples of the period, within the recorded poses
    check_time_span('of the poses', pose.time[-1] - pose.time[0], GRID_PERIOD, len(pose.time))
    begin = np.ceil(pose.time[0] / GRID_PERIOD) * GRID_PERIOD
    count = int(np.floor((pose.time[-1] - begin) / GRID_PERIOD + 1e-9)) + 1
    grid = begin + GRID_PERIOD * np.arange(count)
    at = _interpolate_stream(grid, pose, GAP)
    # Interpolated components have lost the unit norm
    quaternion = at[:, 3:7] / np.linalg.norm(at[:, 3:7], axis=1, keepdims=True)
    readings, noise = _resample_readings(grid, streams.others)
    levels = np.concatenate([estimate_pose_noise(pose.values), np.maximum(noise, LEAST_NOISE[6:])])
    warm = WARM_UP if any(name in streams.others for name in FILTERS) else MOTOR_WARM_UP
    valid = np.asarray(np.isfinite(at).all(axis=1))
    usable = _bridge_gaps(valid) & (grid - grid[0] >= warm)
    # Written so that NaN heights stay usable: short gaps were bridged
    usable &= ~(at[:, 2] <= streams.floor)
    voltage = streams.others.get('voltage')
    # Battery voltage changes slowly: interpolate over up to 5 s.
    volts = (
        np.full(count, np.nan)
        if voltage is None
        else _interpolate_stream(grid, voltage, 5.0)[:, 0]
    )
    return MeasuredFlight(
        grid,
        at[:, :3],
        quaternion,
        readings,
        levels,
        usable,
        streams.commands,
        volts,
        streams.wrench,
        streams.mass,
        pose,
    )
