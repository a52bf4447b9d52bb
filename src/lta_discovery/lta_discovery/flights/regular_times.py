# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Recover regular sampling times from quantized timestamps.

Stamps of 1 ms resolution at 120 Hz come 8, 8 and 9 ms apart; a line through them by their number
is closer to the truth than each stamp. `timestamp_repair` decides how to use the result.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CLOCK_STEPS: Final = (
    0.01,
    0.005,
    0.004,
    0.002,
    0.001,
    5e-4,
    2e-4,
    1e-4,
)  # s; possible resolutions of stamps
EXACT: Final = 2e-6  # s; largest deviation from a step, from floats and conversions
NEARLY: Final = 0.99  # of the stamps have to be on the step
LOST_POSE: Final = 1.4  # usual intervals; a pose is lost in a longer one (and longer by ONE_STEP)
ONE_STEP: Final = 1.25  # steps
SILENCE_GAP: Final = 100  # periods of silence, after which a new raster begins
FEWEST: Final = 50  # fewest poses of a raster
KNOTS: Final = 10.0  # s; between changes of the rate, where a clock drifts
DRIFT_GAIN: Final = 0.9  # of the deviations; a drift is fitted only if it reduces them below this
RASTER_FIT_ROUNDS: Final = 100  # iterations of the fit into the steps
RASTER_JITTER: Final = 2e-5  # s; negligible: 0.02 mm at 1 m/s


def find_stamp_step(time: Array) -> float:
    """Return the resolution of timestamps, 0 where there is none [s]."""
    since = time - time[:1]
    for step in CLOCK_STEPS if len(time) > 1 else ():
        if np.mean(np.abs(since - step * np.round(since / step)) < EXACT) >= NEARLY:
            return step
    return 0.0


def fit_regular_times(time: Array, step: float) -> Array:
    """
    Fit regular sampling times to timestamps, with or without lost poses.

    The rate may drift slowly. A new raster begins after a long silence.

    `time`, shape (n,): rising [s]. `step`: resolution of the stamps, which are off by up to half
    of it [s]. The result has shape (n,): NaN where there are too few poses, or no constant rate
    [s].
    """
    out = np.full(len(time), np.nan)
    if len(time) < FEWEST:
        return out
    apart = np.diff(time)
    usual = np.median(apart)
    period = float(np.mean(apart[apart < max(LOST_POSE * usual, usual + ONE_STEP * step)]))
    for part in np.split(np.arange(len(time)), np.flatnonzero(apart > SILENCE_GAP * period) + 1):
        # Number of periods between poses: more than 1 where poses were lost
        counts = np.round(np.diff(time[part]) / period)
        if len(part) >= FEWEST and np.all(counts > 0.0):
            out[part] = _fit_line(np.concatenate([[0.0], np.cumsum(counts)]), time[part], step)
    return out


def _fit_line(index: Array, time: Array, step: float) -> Array:
    """Fit a line to stamps by index, with bends only where they reduce the error clearly."""
    # Centre the ramp, so that offset and rate are nearly uncorrelated
    middle = time[0] + 0.5 * (time[-1] - time[0])
    knots = np.arange(time[0] + KNOTS, time[-1] - 0.5 * KNOTS, KNOTS)
    at = np.interp(knots, time, index)
    straight = np.column_stack([np.ones(len(index)), index - np.interp(middle, time, index)])
    # A change of the rate at each knot
    bent = np.column_stack([straight, np.maximum(index[:, None] - at, 0.0)])
    line = _fit_within_steps(straight, time, step)
    other = _fit_within_steps(bent, time, step) if len(knots) else line
    return (
        other
        if _excess_deviation(time - other, step)
        < DRIFT_GAIN * _excess_deviation(time - line, step)
        else line
    )


def _excess_deviation(off: Array, step: float) -> float:
    """Return the RMS deviation of stamps beyond rounding [s]."""
    # Deviation beyond rounding; RASTER_JITTER keeps the ratio of two tiny values near 1
    return RASTER_JITTER + float(np.sqrt(np.mean(np.maximum(np.abs(off) - 0.5 * step, 0.0) ** 2)))


def _fit_within_steps(basis: Array, time: Array, step: float) -> Array:
    """Fit stamps to within half a step each, without those that are far off."""
    off = time - basis @ np.linalg.lstsq(basis, time)[0]
    # Leave out late stamps, which would pull the line
    good = np.abs(off) <= 5.0 * np.median(np.abs(off)) + step
    solve = np.linalg.pinv(basis[good])
    target = time
    # Alternate projections: onto the line, then into the interval that rounds to each stamp.
    for _ in range(RASTER_FIT_ROUNDS if step else 1):
        line: Array = basis @ (solve @ target[good])
        target = np.clip(line, time - 0.5 * step, time + 0.5 * step)
    return line
