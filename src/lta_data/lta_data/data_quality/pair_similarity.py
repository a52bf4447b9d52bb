"""Measure the similarity of a pair: lag, correlation and ratio of each axis."""

from dataclasses import dataclass
from typing import final

from lta_data.data_quality import limits
from lta_data.data_quality.motion_pairs import MotionPair
from lta_data.data_quality.smoothing import hann_kernel, narrow_mask, smooth_columns
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
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
