"""
Pair two sources of the same motion, a sensor and what a pose implies for it, and compare them.

Both sides are on one even grid and smoothed with one kernel, so that noise and differentiation
affect them equally. A mismatch means a wrong unit, sign, axis or clock.
"""

from collections.abc import Iterator, Mapping
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


def find_motion_pairs(channels: Mapping[str, SignalChannel]) -> list[MotionPair]:
    """Return all pairs of sources for the same motion."""
    poses, sensors = collect_poses(channels), collect_inertials(channels)
    pairs: list[MotionPair | None] = []
    for pose in poses:
        pairs += _pair_pose(pose)
        for sensor in sensors:
            pairs += _pair_inertial(pose, sensor)
        # An estimate may be computed from these very sensors; prefer a tracker
        if pose.tracked or not any(other.tracked for other in poses):
            pairs += [_pair_height(pose, channel) for channel in channels.values()]
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


SLOW = 3.0  # slower changes are removed as trend [s]
QUICK = 0.5  # least fast motion, relative to the least motion
FINE = 0.5  # match of each moving axis from which axes count as correct


@final
@dataclass(frozen=True, slots=True)
class PairSimilarity:
    """How the left side of a pair follows the right one."""

    lag: float  # delay of the left side [s]
    # Of left axis i with right axis j at that lag; 0 for an axis without motion, shape (k, k)
    correlation: Array
    ratio: Array  # standard deviation of left axis i over that of right axis j, shape (k, k)
    # Concordance of left axis i with right axis j, which takes size into account (Lin 1989,
    # doi:10.2307/2532051, without means), after one common factor for all axes, shape (k, k)
    match: Array
    moving: NDArray[np.bool_]  # axes of the right side that move enough to judge, shape (k,)
    # Correlation of the fast motion of each axis, at the lag and at zero lag; 0 without any, shape
    # (k,)
    quick_at_lag: Array
    quick_at_zero: Array

    @property
    def axes_agree(self) -> bool:
        """Whether each moving axis matches well enough to need no explanation."""
        return bool((np.diag(self.match)[self.moving] > FINE).all())


def robust_deviations(table: Array, valid: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return columns minus their means, 0 where unknown, and their standard deviations."""
    inside = table[valid]
    # Clip outliers: one glitch of a tracker can have more power than the whole flight.
    low, high = np.percentile(inside, [0.5, 99.5], axis=0)
    margin = 0.5 * (high - low)
    # Half the range on either side leaves real extremes unclipped
    clipped = np.clip(table, low - margin, high + margin)
    clipped = np.where(valid[:, None], clipped - clipped[valid].mean(axis=0), 0.0)
    return clipped, np.sqrt((clipped**2).sum(axis=0) / max(1, valid.sum()))


def high_pass_pair(pair: MotionPair) -> tuple[Array, Array, Array, Array]:
    """
    Return the fast part of both sides, each axis scaled to unit variance, and its spreads.

    Changes within seconds determine the lag; a trend correlates at any lag.
    """
    weights = hann_kernel(SLOW, pair.step)
    # Near the ends the trend is wrong, and equally wrong on both sides.
    inside = narrow_mask(pair.valid, weights)
    mask = inside if inside.sum() * pair.step > SLOW else pair.valid
    left, right = (
        robust_deviations(table - smooth_columns(table, weights), mask)
        for table in (pair.left, pair.right)
    )
    one, two = (side / np.where(size > 0.0, size, 1.0) for side, size in (left, right))
    return one, two, left[1], right[1]


def raw_cross_correlations(left: Array, right: Array, most: int) -> Array:
    """Return the sums of left_i[t + lag] right_j[t] over t, for lags -most..most: (2m+1, i, j)."""
    size = 1 << int(len(left) + most).bit_length()
    ahead = np.fft.rfft(left, size, axis=0)[:, :, None]
    behind = np.conj(np.fft.rfft(right, size, axis=0))[:, None, :]
    correlations = np.fft.irfft(ahead * behind, size, axis=0)
    # FFT order: negative lags are at the end
    return np.concatenate((correlations[-most:], correlations[: most + 1]))


def estimate_lag(left: Array, right: Array, step: float, search: float) -> float:
    """
    Return the delay of the left side, by the largest correlation of either sign. [s]

    Any left axis may correspond to a right axis, so that swapped axes do not matter.

    `left`, `right`, shape (n, k): deviations, 0 where unknown, each column scaled by its weight.
    `step`, `search`: step of the grid, and largest lag [s].
    """
    most = max(1, min(round(search / step), len(left) // 2))
    # The best left axis of each right axis counts.
    total = np.abs(raw_cross_correlations(left, right, most)).max(axis=1).sum(axis=1)
    best = int(np.argmax(total))
    # Vertex of the parabola through the peak and its neighbours: a fraction of a grid step
    if 0 < best < 2 * most:
        before, at, after = total[best - 1 : best + 2]
        bend = before - 2 * at + after
        part = 0.0 if bend >= 0 else float(0.5 * (before - after) / bend)
        return (best - most + part) * step
    return (best - most) * step


def measure_similarity(pair: MotionPair) -> PairSimilarity | None:
    """Measure the similarity of a pair; None if the right side hardly moves."""
    left, left_size = robust_deviations(pair.left, pair.valid)
    right, right_size = robust_deviations(pair.right, pair.valid)
    # Axes without motion contain only noise, which must not decide
    moving = (right_size > pair.least) & (left_size > 0.0)
    if not moving.any():
        return None
    unit_left = left / np.where(left_size > 0.0, left_size, 1.0)
    unit_right = right / np.where(right_size > 0.0, right_size, 1.0)
    quick_left, quick_right, _, quick_size = high_pass_pair(pair)
    quick = moving & (quick_size > QUICK * pair.least)
    lag = 0.0
    if quick.any():
        lag = estimate_lag(quick_left, quick_right[:, quick], pair.step, limits.CLOCK_SEARCH)
    count = max(1, int(pair.valid.sum()))
    moved = round(lag / pair.step)
    # Shape (left axes, right axes)
    correlation = np.roll(unit_left, -moved, axis=0).T @ unit_right / count
    ratio = left_size[:, None] / np.where(right_size > 0.0, right_size, np.inf)[None, :]
    # One factor for all axes removes a wrong unit, which another check reports.
    common = float(np.linalg.norm(left_size) / np.linalg.norm(right_size))
    relative = ratio / common
    # Correlation, reduced where the amplitudes differ; equal amplitudes leave it unchanged
    match = 2.0 * correlation * relative / (1.0 + relative**2)
    return PairSimilarity(
        lag, correlation, ratio, match, moving,
        quick_at_lag=_axis_correlation(np.roll(quick_left, -moved, axis=0), quick_right, quick),
        quick_at_zero=_axis_correlation(quick_left, quick_right, quick),
    )  # fmt: skip


def _axis_correlation(left: Array, right: Array, active: NDArray[np.bool_]) -> Array:
    """Return the correlation of each axis with its counterpart; 0 for inactive axes."""
    size = np.linalg.norm(left, axis=0) * np.linalg.norm(right, axis=0)
    return np.where(
        active & (size > 0.0), (left * right).sum(axis=0) / np.maximum(size, 1e-300), 0.0
    )
