# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate the offset between two clocks that timed the same motion.

Coarse step: normalised cross-correlation of the rates of change of several channels at once,
over all lags with enough overlap. Fine step: Gauss-Newton on the channels themselves, for offset
and drift together, with Huber weights. The level of each channel is free in each stretch of ten
seconds, so that a slowly drifting estimate does not bias the clock. The uncertainty comes from
the scatter of whole blocks, so it accounts for autocorrelation.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_data.compare.coarse_lag import (
    both_signals,
    CoarseLag,
    estimate_coarse_lag,
    SharedQuantity,
    unwrap_finite,
)
from lta_data.compare.divergence import NORMAL_QUANTILE
from lta_data.compare.sampling import Array, interpolate_signal
from lta_data.even_grid import is_grid_allowed, median_period, SampledSignal
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator, CubicSpline
from scipy.ndimage import gaussian_filter1d
from scipy.special import stdtrit

LIKE: Final = 0.5  # least correlation of a channel that the fine step uses
MAX_FINE_CHANNELS: Final = 12  # channels of the fine step, at most
LEVEL_TIME: Final = 10.0  # s over which a channel's level is free
HUBER: Final = 1.5  # scaled misfit from which the weight decreases
RESTING_SCALE: Final = 0.1  # least scale of a channel's misfit, relative to its RMS
UNCERTAINTY_BLOCKS: Final = 16  # for the uncertainty
GAUSS_NEWTON_ROUNDS: Final = 30  # Gauss-Newton iterations, at most
INTERPOLATION_ERROR: Final = 1e-3  # periods of uncertainty, for the interpolation error
DRIFT_TIME: Final = 30.0  # s of common time needed to estimate drift
DRIFT_DEVIATIONS: Final = 3.0  # standard deviations above which a drift is applied
QUARTZ: Final = 2e-3  # largest drift of a real clock; more means a different motion
AMBIGUOUS: Final = 0.9  # relative height of a second peak that makes it ambiguous


@final
@dataclass(frozen=True, slots=True)
class ClockOffset:
    """Reading of B's clock minus that of A's at the same event."""

    # Offset in the middle of the common span, and its standard deviation [s]
    value: float
    sigma: float
    # Rate of growth of the offset; applied only if `drifts`. Zero and infinite if the common span
    # is too short to estimate it [1]
    drift: float
    drift_sigma: float
    drifts: bool  # whether the drift is significant and plausible for a clock
    middle: float  # time of `value` on A's clock [s]
    correlation: float  # median correlation of the rates of the channels in `used`, at this offset
    rival: float  # height of the highest other peak, relative to the best
    used: tuple[str, ...]  # the channels of the fine step

    @property
    def is_ambiguous(self) -> bool:
        """Whether another offset fits nearly as well, as with a periodic motion."""
        return self.rival > AMBIGUOUS


def estimate_clock_offset(shared: Sequence[SharedQuantity]) -> ClockOffset | None:
    """
    Return the offset between two clocks; None if no channel determines it.

    The quantities must not depend on a world frame.
    """
    coarse = estimate_coarse_lag(shared)
    if coarse is None:
        return None
    like = {name: value for name, value in coarse.correlations.items() if value > LIKE}
    names = sorted(like, key=lambda name: -like[name])[:MAX_FINE_CHANNELS]
    used = [each for each in shared if each.name in names and can_be_prepared(each)]
    return (
        refine_offset(used, coarse, float(np.median([like[name] for name in names])))
        if used
        else None
    )


def can_be_prepared(each: SharedQuantity) -> bool:
    """Return whether both sides fit on a grid with the step of the finer one."""
    step = min(median_period(line.time) for line in both_signals(each))
    return all(
        is_grid_allowed(float(line.time[-1] - line.time[0]), step, len(line.time))
        for line in both_signals(each)
    )


class PreparedChannel(NamedTuple):
    """One channel for the fine step: A sampled, B as a spline, and the smoothing width in s."""

    time: Array
    a: Array
    line: SampledSignal
    b: CubicSpline
    width: float


def prepare_channel(each: SharedQuantity) -> PreparedChannel:
    """Resample and smooth both sides of a channel equally, and fit a spline to B."""
    lines = [unwrap_finite(line, each.angular) for line in both_signals(each)]
    periods = [median_period(line.time) for line in lines]
    # Smoothing by the slower period gives both sides the same bandwidth.
    step, width = min(periods), 1.5 * max(periods)  # s
    pieces = []
    for line in lines:
        count = 2 + int((line.time[-1] - line.time[0]) / step)
        grid = line.time[0] + step * np.arange(count)
        seen = interpolate_signal(line, grid)
        # Linear interpolation would cut the bends of the slower recording.
        curve = Akima1DInterpolator(line.time, line.values)(np.minimum(grid, line.time[-1]))
        smooth = gaussian_filter1d(curve, width / step)
        pieces.append((grid, smooth, seen))
    (grid, a, seen), (grid_b, b, seen_b) = pieces
    inner = np.isfinite(seen)
    return PreparedChannel(
        grid[inner], a[inner], SampledSignal(grid_b, seen_b), CubicSpline(grid_b, b), width
    )


def refine_offset(
    used: Sequence[SharedQuantity], start: CoarseLag, correlation: float
) -> ClockOffset:
    """Return the offset [s] and drift [1] with the smallest misfit, and their uncertainty."""
    channels = [prepare_channel(each) for each in used]
    shift = start.lag
    begin = min(float(each.time[0]) for each in channels)
    end = max(float(each.time[-1]) for each in channels)
    # Limit the span to times that B covers too, on A's clock
    begin = max(begin, min(float(each.line.time[0]) for each in channels) - shift)
    end = min(end, max(float(each.line.time[-1]) for each in channels) - shift)
    middle, span = 0.5 * (begin + end), end - begin
    step = min(median_period(each.time) for each in channels)
    # Offset and drift are referred to the middle of the span, where they hardly correlate.
    both = fit_offset(channels, np.array([shift, 0.0]), middle, span, step, 2)
    telling = span >= DRIFT_TIME
    # Over a short span the data hardly determine a drift
    deviation = math.sqrt(both.covariance[1, 1]) if telling else math.inf
    drifts = telling and DRIFT_DEVIATIONS * deviation < abs(float(both.values[1])) < QUARTZ
    single = (
        both if drifts else fit_offset(channels, np.array([shift, 0.0]), middle, span, step, 1)
    )
    return ClockOffset(
        value=float(single.values[0]),
        sigma=math.hypot(math.sqrt(single.covariance[0, 0]), INTERPOLATION_ERROR * step),
        drift=float(both.values[1]) if telling else 0.0,
        drift_sigma=deviation,
        drifts=drifts,
        middle=middle,
        correlation=correlation,
        rival=start.rival,
        used=tuple(each.name for each in used),
    )


class OffsetFit(NamedTuple):
    """Offset and drift, and their covariance, shape (2, 2)."""

    values: Array
    covariance: Array


def fit_offset(
    channels: Sequence[PreparedChannel],
    at: Array,
    middle: float,
    span: float,
    step: float,
    free: int,
) -> OffsetFit:
    """Fit the offset [s], and the drift [1] if `free` is 2, by Gauss-Newton."""
    # Inner edges only: the first and last block are open, so every sample has a block
    edges = np.linspace(middle - span / 2, middle + span / 2, UNCERTAINTY_BLOCKS + 1)[1:-1]
    for _ in range(GAUSS_NEWTON_ROUNDS):
        parts = [build_normal_equations(each, at, middle, edges, free) for each in channels]
        normal, curvature, blocks = (np.sum(part, axis=0) for part in zip(*parts, strict=True))
        # Without motion in the common time, the step is undefined
        if np.linalg.matrix_rank(normal) != free:
            break
        change = np.linalg.solve(normal, blocks.sum(axis=0))
        at = at + np.pad(change, (0, 2 - free))
        # Far below the interpolation error: converged.
        if abs(change[0]) < 1e-7 * step:
            break
    covariance = np.full((2, 2), math.inf)
    if np.linalg.matrix_rank(curvature) == free:
        # Sandwich estimator over blocks: valid for autocorrelated misfits.
        inverse = np.linalg.inv(curvature)
        # BLOCKS / (BLOCKS - free) corrects for the fitted parameters.
        spread = blocks.T @ blocks * (UNCERTAINTY_BLOCKS / (UNCERTAINTY_BLOCKS - free))
        covariance[:free, :free] = inverse @ spread @ inverse * variance_inflation(channels, span)
    return OffsetFit(at, covariance)


def variance_inflation(channels: Sequence[PreparedChannel], span: float) -> float:
    """
    Return the factor that corrects a variance estimated from the scatter of blocks.

    Two misfits a lag s apart, both smoothed by a Gaussian of width w, correlate by
    exp(-s^2 / 4 w^2). Blocks of length L lose 2 w / (sqrt(pi) L) of the sum at their edges.
    Student's t corrects for the small number of blocks.
    """
    width = max(each.width for each in channels)
    lost = (
        min(0.5, 2.0 * width * UNCERTAINTY_BLOCKS / (math.sqrt(math.pi) * span))
        if span > 0.0
        else 0.5
    )
    # Student's t for few blocks, relative to the normal quantile
    few = float(stdtrit(UNCERTAINTY_BLOCKS - 1, 0.975)) / NORMAL_QUANTILE
    return few**2 / (1.0 - lost)


def build_normal_equations(
    each: PreparedChannel, at: Array, middle: float, edges: Array, free: int
) -> tuple[Array, Array, Array]:
    """Return one channel's normal matrix, its curvature, and its gradient in each block."""
    moved = each.time + at[0] + at[1] * (each.time - middle)
    valid = np.isfinite(interpolate_signal(each.line, moved))
    time, moved = each.time[valid], moved[valid]
    # Too few samples to determine levels and slopes.
    if len(time) < 8:
        return np.zeros((free, free)), np.zeros((free, free)), np.zeros((UNCERTAINTY_BLOCKS, free))
    # The level of each stretch is free: slow drifts of an estimate must not bias the clock.
    stretch = ((time - time[0]) // LEVEL_TIME).astype(np.int64)
    misfit = subtract_block_means(each.a[valid] - each.b(moved), stretch)
    slope = subtract_block_means(each.b(moved, 1), stretch)
    # 1.4826: standard deviation from the median absolute deviation of normal noise.
    scale = 1.4826 * float(np.median(np.abs(misfit)))
    # A channel that is at rest most of the time has a median misfit of zero, but is not exact.
    scale = max(scale, RESTING_SCALE * math.sqrt(float(np.mean(misfit**2))))
    scale = max(scale, 1e-9 * float(np.ptp(each.a[valid])), 1e-150)
    size = np.abs(misfit) / scale
    # Huber weights; the division by scale**2 makes channels of any unit comparable
    weight = np.where(size > HUBER, HUBER / np.maximum(size, HUBER), 1.0) / scale**2
    # Derivatives by offset and by drift, shape (n, free)
    slopes = np.stack([slope, slope * (time - middle)][:free], axis=1)
    pulls = slopes * (weight * misfit)[:, None]
    index = np.searchsorted(edges, time)
    blocks: Array = np.stack(
        [np.bincount(index, pull, UNCERTAINTY_BLOCKS) for pull in pulls.T], axis=1
    )
    # A step by the curvature, to which only misfits within the limit contribute, would overshoot
    # where most misfits are outliers, as without noise: the weighted squares never do
    normal, curvature = (
        slopes.T @ (slopes * one[:, None]) for one in (weight, (size <= HUBER) / scale**2)
    )
    return normal, curvature, blocks.astype(np.float64)


def subtract_block_means(values: Array, stretch: NDArray[np.int64]) -> Array:
    """Return values minus their mean in each stretch, shape (n,)."""
    counts = np.maximum(np.bincount(stretch), 1)
    means = np.bincount(stretch, values) / counts
    return np.asarray(values - means[stretch])
