"""
Pair two sources of the same motion: a sensor, and what a pose implies for it.

Both sides are on one even grid and smoothed with one kernel, so that noise and differentiation
affect them equally. A mismatch means a wrong unit, sign, axis or clock.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_data.bag.channels import SignalChannel
from lta_data.data_quality import limits, roles
from lta_data.data_quality.motion import (
    collect_inertials,
    collect_poses,
    compute_body_rates,
    InertialSeries,
    PoseSeries,
    VectorSeries,
)
from lta_data.data_quality.recording import ChannelRecording
from lta_data.data_quality.smoothing import (
    hann_kernel,
    interpolate_on_grid,
    median_period,
    narrow_mask,
    smooth_columns,
    sort_samples,
)
from lta_data.even_grid import build_uniform_time_grid
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
AIR: float = 1.2 * STANDARD_GRAVITY  # pressure drop per metre of height, at 1.2 kg/m3 [Pa/m]
FINEST = 0.01  # smallest step of the grid [s]


@final
@dataclass(frozen=True, slots=True)
class MotionPair:
    """Two sources of the same motion."""

    what: str  # 'rates', 'velocity', 'force', 'range' or 'pressure'
    # Name of the sensor's vector, and of the pose's from which the other side is derived
    sensor: str
    reference: str
    unit: str  # of both sides
    least: float  # smallest standard deviation of `right` that counts as motion
    grid: Array  # shape (n,) [s]
    # Measured and derived values, one axis per column, shape (n, k)
    left: Array
    right: Array
    valid: NDArray[np.bool_]  # where both are known, shape (n,)
    axes: tuple[str, ...] = ('x', 'y', 'z')  # names of the columns

    @property
    def step(self) -> float:
        """Step of the grid. [s]"""
        return float(self.grid[1] - self.grid[0])

    @property
    def span(self) -> tuple[float, float]:
        """First and last time at which both are known. [s]"""
        times = self.grid[self.valid]
        return float(times[0]), float(times[-1])


def find_motion_pairs(recording: ChannelRecording) -> list[MotionPair]:
    """Return all pairs of sources for the same motion."""
    poses, sensors = collect_poses(recording.channels), collect_inertials(recording.channels)
    pairs: list[MotionPair | None] = []
    for pose in poses:
        pairs += _pair_pose(pose)
        for sensor in sensors:
            pairs += _pair_inertial(pose, sensor)
        # An estimate may be computed from these very sensors; prefer a tracker
        if pose.tracked or not any(other.tracked for other in poses):
            pairs += [_pair_height(pose, channel) for channel in recording.channels.values()]
    return [pair for pair in pairs if pair is not None]


def _pair_pose(pose: PoseSeries) -> Iterator[MotionPair | None]:
    """Pair a pose with the velocities in the same message."""
    if pose.attitude is None:
        return
    if pose.turning is not None:
        yield pair_rates(pose.turning, pose.attitude)
    if pose.position is not None and pose.velocity is not None and pose.tracked:
        yield pair_velocity(pose.position, pose.attitude, pose.velocity)


def pair_rates(measured: VectorSeries, attitude: VectorSeries) -> MotionPair | None:
    """Pair angular rates with the derivative of an attitude."""
    times, rates = compute_body_rates(attitude)
    return _resample_pair('rates', measured, attitude.name, times, rates)


def pair_velocity(
    place: VectorSeries, attitude: VectorSeries, measured: VectorSeries
) -> MotionPair | None:
    """Pair a velocity with the derivative of position, in the body frame."""
    times, speeds = place.differentiate()
    turn = interpolate_attitude(attitude, times)
    return _resample_pair('velocity', measured, place.name, times, turn.inv().apply(speeds))


def _pair_inertial(pose: PoseSeries, sensor: InertialSeries) -> Iterator[MotionPair | None]:
    if pose.attitude is None:
        return
    if sensor.rates is not None:
        yield pair_rates(sensor.rates, pose.attitude)
    if sensor.force is not None and pose.position is not None and pose.tracked:
        yield pair_force(pose.position, pose.attitude, sensor.force)


def pair_force(
    place: VectorSeries, attitude: VectorSeries, measured: VectorSeries
) -> MotionPair | None:
    """Pair a specific force with acceleration plus gravity, in the body frame."""
    step = max(median_period(place.time), FINEST)
    grid = build_uniform_time_grid(place.time[0], place.time[-1], step, len(place.time))
    if len(grid) * step < limits.PAIR_TIME:
        return None
    table, _ = interpolate_on_grid(place.time, place.values, grid)
    smooth = smooth_columns(table, hann_kernel(limits.KERNEL, step))
    # Smooth before differentiating twice, which amplifies noise.
    pull = np.gradient(np.gradient(smooth, step, axis=0), step, axis=0)
    # An accelerometer at rest measures +g along z (up)
    pull[:, 2] += STANDARD_GRAVITY
    force = interpolate_attitude(attitude, grid).inv().apply(pull)
    return _resample_pair('force', measured, place.name, grid, force)


def _pair_height(pose: PoseSeries, channel: SignalChannel) -> MotionPair | None:
    """Pair a downward range or an air pressure with the height of a pose."""
    is_range = channel.field == 'range'
    if pose.position is None or not (is_range or roles.PRESSURE.match(channel.field)):
        return None
    time, values = sort_samples(channel.time, channel.values[:, None])
    if len(time) < limits.LEAST_SAMPLES:
        return None
    # Pressure falls with height.
    height = values if is_range else -values / AIR
    heights = VectorSeries(channel.name, time, height)
    what = 'range' if is_range else 'pressure'
    place = pose.position
    return _resample_pair(what, heights, place.name, place.time, place.values[:, 2:])  # z only


def interpolate_attitude(attitude: VectorSeries, times: Array) -> Rotation:
    """Return attitudes at other times, linear in the quaternion between samples."""
    table, _ = interpolate_on_grid(attitude.time, attitude.values, times)
    return Rotation.from_quat(table)


LEAST = {
    'rates': ('rad/s', limits.TURN_MOTION),
    'velocity': ('m/s', limits.SPEED_MOTION),
    'force': ('m/s2', limits.FORCE_MOTION),
    'range': ('m', limits.HEIGHT_MOTION),
    'pressure': ('m', limits.HEIGHT_MOTION),
}


def _resample_pair(
    what: str, measured: VectorSeries, derived_from: str, time: Array, derived: Array
) -> MotionPair | None:
    """Resample two sides to one grid; None if they overlap too briefly."""
    if len(time) < limits.LEAST_SAMPLES or len(measured.time) < limits.LEAST_SAMPLES:
        return None
    step = max(median_period(time), median_period(measured.time), FINEST)
    begin, end = max(time[0], measured.time[0]), min(time[-1], measured.time[-1])
    # Negated, so that NaN counts as too short
    if not end - begin >= limits.PAIR_TIME:
        return None
    grid = build_uniform_time_grid(begin, end, step, len(time) + len(measured.time))
    if not len(grid):
        return None
    weights = hann_kernel(limits.KERNEL, step)
    left, there = interpolate_on_grid(measured.time, measured.values, grid)
    right, also = interpolate_on_grid(time, derived, grid)
    # Exclude points whose smoothing window touches a gap.
    mask = narrow_mask(there & also, weights)
    if mask.sum() * step < limits.PAIR_TIME:
        return None
    unit, least = LEAST[what]
    axes = ('x', 'y', 'z') if measured.values.shape[1] == 3 else ('',)
    return MotionPair(
        what, measured.name, derived_from, unit, least, grid,
        # The same kernel on both sides, so that smoothing causes no lag between them
        smooth_columns(left, weights), smooth_columns(right, weights), mask, axes,
    )  # fmt: skip
