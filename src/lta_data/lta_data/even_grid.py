# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Check whether the time stamps of a recording allow an even grid, and build it.

A computer that sets its clock while recording, by hours or from 1970 to today, creates stamps
that span years: a 100 Hz grid over them would not fit into memory. So every size that follows from
a span of time is checked here against the number of messages.
"""

from collections.abc import Iterator
from typing import final, NamedTuple

from lta_config.errors import BadInput
from lta_config.limits import GRID_POINTS
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import fftconvolve

NO_SAMPLES = np.empty(0)
HOLES = 3.0  # grid points per sample, at most; more would be mostly gaps
FINEST = 1e-9  # s; resolution of a ROS stamp


def is_grid_allowed(span: float, step: float, samples: int, most: float = HOLES) -> bool:
    """Return whether a grid over so many samples may have such a span and step [s]."""
    # Short grids are always allowed, however sparse.
    return span / max(FINEST, step) <= max(GRID_POINTS, most * samples)


def check_time_span(
    who: str, span: float, step: float, samples: int, most: float = HOLES, remedy: str = ''
) -> None:
    """
    Refuse time stamps that span too long for their number.

    Parameters
    ----------
    who : str
        Whose time stamps they are, as in "of 'odom'"; may be empty.
    span, step : float
        From the first to the last, and of the grid that is needed. [s]
    samples : int
        Number of messages.
    most : float
        Grid points per message, at most.
    remedy : str
        What else helps, before 'check with ...'; may be empty.

    Raises
    ------
    BadInput
        If the grid would have far more points than there are messages.

    """
    if is_grid_allowed(span, step, samples, most):
        return
    raise BadInput(
        f'The time stamps{f" {who}" if who else ""} span {span:.0f} s, too long to resample at '
        f'{1.0 / max(FINEST, step):g} Hz; {f"{remedy}, or " if remedy else ""}check with '
        '`lta bag check` whether the system clock was changed during the recording.'
    )


def build_uniform_time_grid(
    first: float, last: float, step: float, samples: int
) -> NDArray[np.float64]:
    """Return an even grid over `samples` samples, empty if it would be too long [s]."""
    allowed = is_grid_allowed(last - first, step, samples)
    return np.arange(first, last, max(FINEST, step)) if allowed else NO_SAMPLES


Array = NDArray[np.float64]
BRIDGED_PERIODS = 3.0  # periods without a sample from which nothing is interpolated
DELIVERED_TOGETHER = 32  # messages that a network may deliver at once
IN_A_ROW = 3  # messages that a network may deliver late together
LATE_SHARE = 0.05  # share of late messages beyond which the time stamps are wrong
ABSURD = 1e30  # larger than any real value: some drivers write it for 'unknown'
UNEVEN = 0.3  # of a period by which steps of a steady rhythm differ, at most
UNSTEADY_SHARE = 0.02  # share of larger differences from which a rhythm is not steady


@final
class SampledSignal(NamedTuple):
    """Increasing times [s], shape (n,), and values, shape (n,) or (n, k); NaN where unknown."""

    time: Array
    values: Array

    def select_complete(self) -> 'SampledSignal':
        """Return the samples without an unknown value."""
        good = np.isfinite(self.values.reshape(len(self.values), -1)).all(axis=1)
        return SampledSignal(self.time[good], self.values[good])


def mask_absurd_values(values: ArrayLike) -> Array:
    """Replace infinite and absurdly large values by NaN."""
    numbers = np.asarray(values, dtype=np.float64)
    return np.where(np.abs(numbers) < ABSURD, numbers, np.nan)


def find_late_messages(time: Array) -> NDArray[np.bool_]:
    """
    Return which messages arrived after later ones, as on a network without order, shape (n,).

    Where a clock is set back, all messages are behind until it has caught up; here, a few are.
    """
    behind = time < np.maximum.accumulate(time)
    late = np.zeros(len(time), dtype=bool)
    for begin, end in find_runs(behind).tolist():
        late[begin:end] = end - begin <= IN_A_ROW
    return late if late.mean() <= LATE_SHARE else np.zeros(len(time), dtype=bool)


def sort_samples(time: ArrayLike, values: ArrayLike) -> SampledSignal:
    """
    Return samples in the order of their times; of several at one time, the first.

    Messages that arrived late are put in order. Where a clock was set back, those until it has
    caught up are left out: they would be mixed with others. So are those without a time.
    """
    when, what = np.asarray(time, dtype=np.float64), mask_absurd_values(values)
    usable = np.isfinite(when)
    when, what = when[usable], what[usable]
    if len(when) > 1 and (np.diff(when) <= 0.0).any():
        order = np.flatnonzero(find_late_messages(when) | (when >= np.maximum.accumulate(when)))
        _, first = np.unique(when[order], return_index=True)
        when, what = when[order[first]], what[order[first]]
    return SampledSignal(when, what)


def median_period(time: Array) -> float:
    """
    Return the median time between samples; NaN for fewer than two [s].

    Over several samples, since a network may deliver some together.
    """
    apart = min(DELIVERED_TOGETHER, len(time) - 1)
    if apart < 1:
        return float('nan')
    return float(np.median(time[apart:] - time[:-apart])) / apart


def spread_evenly(time: Array, values: Array) -> tuple[Array, Array]:
    """
    Return samples on an even grid where messages came irregularly, as when stamped on arrival.

    A difference of two samples that came together is no derivative: they count as one, at their
    mean time. Times of a steady rhythm are returned as they are; holes stay.

    `time`, shape (n,): increasing [s]. `values`, shape (n, k).
    """
    step, usual = np.diff(time), median_period(time)
    if (
        len(time) < DELIVERED_TOGETHER
        or np.mean(np.abs(step - usual) > UNEVEN * usual) < UNSTEADY_SHARE
    ):
        return time, values
    starts = np.concatenate(([0], np.flatnonzero(step > UNEVEN * usual) + 1))
    count = np.diff(np.append(starts, len(time)))
    means = np.add.reduceat(np.column_stack([time, values]), starts) / count[:, None]
    grid = build_uniform_time_grid(means[0, 0], means[-1, 0], usual, len(time))
    if len(grid) < DELIVERED_TOGETHER:
        return time, values
    table, there = interpolate_on_grid(means[:, 0], means[:, 1:], grid)
    return grid[there], table[there]


def interpolate_on_grid(
    time: Array, values: Array, grid: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """
    Interpolate values linearly on a grid, with a mask of valid points.

    `time`, shape (n,): increasing [s]. `values`, shape (n, k). `grid`, shape (m,) [s].
    """
    table = np.stack([np.interp(grid, time, column) for column in values.T], axis=1)
    # Index of the sample behind each grid point; the clip covers points outside
    after = np.clip(np.searchsorted(time, grid), 1, len(time) - 1)
    width = time[after] - time[after - 1]
    inside = (grid >= time[0]) & (grid <= time[-1])
    return table, inside & (width <= BRIDGED_PERIODS * median_period(time))


LONG_KERNEL = 4096  # of times in a wrong unit; by Fourier transforms, it does not take minutes


def hann_kernel(width: float, step: float) -> Array:
    """Return a Hann window of a width, normalised to one; of odd length, at least three."""
    # No signal has more samples within the width than the longest grid
    half = max(1, round(min(width / max(FINEST, step) / 2, GRID_POINTS)))
    # The first and last point of a Hann window are zero.
    window = np.hanning(2 * half + 3)[1:-1]
    return np.asarray(window / window.sum(), dtype=np.float64)


def smooth_columns(table: Array, weights: Array) -> Array:
    """Convolve columns with a kernel; the ends are padded with the edge values."""
    # Padded by half the kernel, so that the result has the length of the table and no lag
    half = len(weights) // 2
    wide = np.pad(table, ((half, half), (0, 0)), mode='edge')
    convolve = np.convolve if len(weights) < LONG_KERNEL else fftconvolve
    return np.stack([convolve(column, weights, mode='valid') for column in wide.T], axis=1)


ROUNDING_SHARE = (
    1e-9  # of the range of a channel; smaller changes are rounding errors of a computer
)
NEAR_UNIT = 0.05  # of a unit of the resolution
COARSE_UNITS = 2.0  # units; readings that change less at random follow each other predictably


def find_runs(true: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return first and one-past-last index of each run of True, shape (n, 2)."""
    # False at both ends, so that runs there are closed as well.
    edges = np.flatnonzero(np.diff(np.concatenate(([False], true, [False])).astype(np.int8)))
    return edges.reshape(-1, 2)


def merge_runs(bounds: NDArray[np.int64], apart: int) -> Iterator[tuple[int, int]]:
    """Yield runs, merging those at most `apart` samples apart."""
    held: tuple[int, int] | None = None
    for begin, end in bounds.tolist():
        if held is not None and begin - held[1] <= apart:
            held = held[0], end
        else:
            if held is not None:
                yield held
            held = begin, end
    if held is not None:
        yield held


def find_coarse_unit(values: NDArray[np.float64]) -> float:
    """
    Return the unit to which readings are rounded, if that hides their noise; 0 otherwise.

    Rounded readings of a smooth motion repeat, rest at extremes and come again, by no fault.
    """
    values = values[np.isfinite(values)]
    steps = np.abs(np.diff(values))
    moving = steps[steps > ROUNDING_SHARE * np.ptp(values)] if len(values) else steps
    if not len(moving):
        return 0.0
    units = moving / moving.min()
    on_scale = np.percentile(np.abs(units - np.round(units)), 98.0) < NEAR_UNIT
    noise = float(np.median(np.abs(np.diff(values, 2))))
    return float(moving.min()) if on_scale and noise < COARSE_UNITS * moving.min() else 0.0
