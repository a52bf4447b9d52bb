"""Resample channels to an even grid and smooth them, so that derivatives can be compared."""

from lta_config.limits import GRID
from lta_data.even_grid import FINEST
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
HOLE = 4.0  # periods without a sample that count as a gap
HURRIED = 0.3  # of a period; shorter steps follow a late message
OFTEN = 0.02  # share of such steps from which times are those of arrivals
AROUND = 0.3  # over which arrivals are averaged [s]
LATEST = 3.0  # periods by which a message arrives late, at most


def sort_samples(time: Array, values: Array) -> tuple[Array, Array]:
    """Return finite samples with strictly increasing time; values may have columns."""
    good = np.isfinite(time) & np.isfinite(values.reshape(len(values), -1)).all(axis=1)
    time, values = time[good], values[good]
    if len(time) > 1 and (np.diff(time) <= 0.0).any():
        # Keep a sample only if it is later than all before it.
        rising = time > np.concatenate(([-np.inf], np.maximum.accumulate(time)[:-1]))
        time, values = time[rising], values[rising]
    return time, values


def median_period(time: Array) -> float:
    """Return the median time between samples; NaN for fewer than two. [s]"""
    return float(np.median(np.diff(time))) if len(time) > 1 else float('nan')


def steady_arrivals(time: Array) -> Array:
    """
    Return the times of an even rhythm where messages were stamped on arrival, late by chance.

    A derivative over two messages that arrived together is meaningless. Other times are returned
    as they are. `time`: increasing, shape (n,) [s].
    """
    step, usual = np.diff(time), median_period(time)
    if len(time) < 10 or not usual > 0.0 or np.mean(step < HURRIED * usual) < OFTEN:
        return time
    half = max(2, round(AROUND / usual / 2))
    evened = time.copy()
    cuts = np.flatnonzero(step > HOLE * usual) + 1
    for rows in np.split(np.arange(len(time)), cuts):
        if len(rows) > 2 * half:
            count = np.arange(len(rows))
            # A line through the stretch, so that its ends are averaged without a bias
            line = np.polyval(np.polyfit(count, time[rows], 1), count)
            late = (time[rows] - line)[:, None]
            evened[rows] = line + smooth_columns(late, hann_kernel(2.0 * half, 1.0))[:, 0]
    rising = bool((np.diff(evened) > 0.0).all())
    return evened if rising and np.abs(evened - time).max() < LATEST * usual else time


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
    return table, inside & (width <= HOLE * median_period(time))


def hann_kernel(width: float, step: float) -> Array:
    """Return a Hann window of a width, normalised to one; of odd length, at least three."""
    # No signal has more samples within the width than the longest grid
    half = max(1, round(min(width / max(FINEST, step) / 2, GRID)))
    # The first and last point of a Hann window are zero.
    window = np.hanning(2 * half + 3)[1:-1]
    return np.asarray(window / window.sum(), dtype=np.float64)


def smooth_columns(table: Array, weights: Array) -> Array:
    """Convolve columns with a kernel; the ends are padded with the edge values."""
    # Padded by half the kernel, so that the result has the length of the table and no lag
    half = len(weights) // 2
    wide = np.pad(table, ((half, half), (0, 0)), mode='edge')
    return np.stack([np.convolve(column, weights, mode='valid') for column in wide.T], axis=1)


def narrow_mask(valid: NDArray[np.bool_], weights: Array, times: int = 1) -> NDArray[np.bool_]:
    """Return where a smoothed value depends only on valid samples."""
    reach = times * (len(weights) // 2) + 1
    # Dilates the invalid samples by the reach; 0.5 separates the counts 0 and 1
    bad = np.convolve(~valid, np.ones(2 * reach + 1), mode='same') > 0.5
    # Padded values beyond the ends are invalid too
    bad[:reach] = bad[-reach:] = True
    return ~bad
