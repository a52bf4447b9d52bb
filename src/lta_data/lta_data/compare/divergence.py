# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Measure how much two channels differ, and find when: from when on by more than their noise."""

from dataclasses import dataclass
import math
from typing import Final, final

from lta_data.compare.sampling import AlignedSignals, Array, wrap_angle
import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate
from scipy.special import stdtrit

UPPER_QUANTILE: Final = 0.975  # upper end of a 95 % interval
# Degrees of freedom per independent value: with 10 or more, 84 to 99 % of intervals hold the truth
FREEDOM_SHARE: Final = 0.125
NORMAL_QUANTILE: Final = 1.959964  # quantile of the normal distribution for the same tail


@final
@dataclass(frozen=True, slots=True)
class DifferenceMeasures:
    """The difference of two channels, B minus A, on their common span."""

    count: int  # instants at which both values are known
    # Mean and root mean square [unit of the channel]
    bias: float
    rms: float
    # 95 % interval of `rms`
    rms_low: float
    rms_high: float
    # The largest difference in magnitude, and its time [unit; s]
    greatest: float
    greatest_at: float
    spread: float  # standard deviation of A at the same instants
    nrmse: float | None  # rms / spread; None if A is constant


def measure_difference(
    pair: AlignedSignals, *, angular: bool = False
) -> DifferenceMeasures | None:
    """
    Return the measures of two channels; None if they have no common valid sample.

    For angular channels, the spread of A is taken about its mean direction.
    """
    valid = pair.both_valid
    if not valid.any():
        return None
    difference, time, a = pair.difference[valid], pair.time[valid], pair.a[valid]
    most = int(np.abs(difference).argmax())
    rms = math.sqrt(float(np.mean(difference**2)))
    low, high = rms_interval(difference)
    spread = standard_deviation(a, angular)
    return DifferenceMeasures(
        count=len(difference),
        bias=float(np.mean(difference)),
        rms=rms,
        rms_low=low,
        rms_high=high,
        greatest=float(difference[most]),
        greatest_at=float(time[most]),
        spread=spread,
        nrmse=rms / spread if spread > 0.0 else None,
    )


def standard_deviation(values: Array, angular: bool) -> float:
    """Return the standard deviation of finite values, in their unit; zero if all are equal."""
    # np.std of equal numbers can round to slightly more than zero.
    if not len(values) or np.ptp(values) == 0.0:
        return 0.0
    if angular:
        # Circular mean: angles near +pi and -pi belong together.
        middle = math.atan2(float(np.mean(np.sin(values))), float(np.mean(np.cos(values))))
        return float(np.std(wrap_angle(values - middle)))
    return float(np.std(values))


def autocorrelation_time(values: Array) -> float:
    """
    Return the integrated autocorrelation time in samples: 1 for white noise.

    The sum is cut off at five times its own value (Sokal 1997, "Monte Carlo methods in
    statistical mechanics").
    """
    centred = values - values.mean()
    count = len(centred)
    # The autocorrelation at lag zero, by which the others are normalised
    power = float(np.dot(centred, centred))
    if count < 4 or power == 0.0:
        return 1.0
    correlation = correlate(centred, centred, method='fft')[count - 1 :] / power
    # Integrated autocorrelation time up to each lag, both sides; lag zero counts once
    total = 2.0 * np.cumsum(correlation) - 1.0
    # Sokal's window: stop at five times the estimate, before noise dominates the sum
    inside = np.arange(len(total)) >= 5.0 * total
    return max(1.0, float(total[inside.argmax()] if inside.any() else total.max()))


def rms_interval(difference: Array) -> tuple[float, float]:
    """
    Return the 95 % interval of the RMS of an autocorrelated series.

    The mean square has the standard error of as many independent values as the series has
    autocorrelation times. Its logarithm is taken to follow Student's t, as it is positive.
    """
    squares = difference**2
    mean = float(np.mean(squares))
    if len(squares) < 2 or np.ptp(squares) == 0.0 or mean == 0.0:
        return math.sqrt(mean), math.sqrt(mean)
    independent = max(2.0, len(squares) / autocorrelation_time(squares))
    error = float(np.std(squares)) / mean / math.sqrt(independent)
    # The square of a normal value scatters widely, and the autocorrelation time is estimated too
    freedom = max(1.0, FREEDOM_SHARE * independent)
    # At 700 exp() is near the largest float
    half = min(700.0, 0.5 * error * float(stdtrit(freedom, UPPER_QUANTILE)))
    # A mean cannot lie outside the range of the averaged values.
    low, high = math.sqrt(float(squares.min())), math.sqrt(float(squares.max()))
    return max(math.sqrt(mean) * math.exp(-half), low), min(math.sqrt(mean) * math.exp(half), high)


SIGMAS: Final = 4.0  # of the combined noise; 6 of 100 000 normal samples lie outside
IRRELEVANT_SHARE: Final = 1e-3  # of the spread; smaller differences are irrelevant
NORMAL: Final = 1.4826  # standard deviation over median absolute deviation
MIN_LEVELS: Final = 6  # least distinct values of a quantised measurement; fewer: a command
SECOND_DIFFERENCE_NOISE: Final = math.sqrt(
    6.0
)  # standard deviation of second differences of unit white noise
SHORTEST_DIVERGENCE: Final = 1.0  # s that a divergence must last, or 2 % of the span
SPAN_SHARE: Final = 0.02
MIN_DIVERGENT_SAMPLES: Final = 10  # samples that a divergence must last


@final
@dataclass(frozen=True, slots=True)
class Divergence:
    """When two channels differ."""

    band: float  # largest difference explained by noise, or the tolerance [unit]
    given: bool  # whether the band is a tolerance set by the user
    at: float | None  # time from which they differ to the end; None if they agree at the end [s]
    first: float | None  # time when they first differ for longer than a moment [s]
    outside: float  # share of the samples outside the band


def noise_deviation(values: Array) -> float:
    """
    Return the standard deviation of the noise on an otherwise smooth signal.

    Without white noise, a signal with many distinct levels, such as an ADC's, has quantisation
    noise: the smallest step over sqrt(12). Few levels mean a command, which has no noise. Noise
    that was filtered out before recording is not detected. NaN values are ignored.
    """
    deviation = white_noise_deviation(values)
    # Only a signal without white noise can be limited by quantisation.
    # A median of zero: most neighbours are equal, as after rounding
    levels = np.unique(values[np.isfinite(values)]) if deviation == 0.0 else np.empty(0)
    # Standard deviation of rounding to steps: step / sqrt(12)
    return (
        float(np.diff(levels).min()) / math.sqrt(12.0) if len(levels) >= MIN_LEVELS else deviation
    )


def white_noise_deviation(values: Array) -> float:
    """
    Return the standard deviation of the white noise on a signal.

    It comes from the median magnitude of second differences, which ignores linear trends and
    single outliers.
    """
    # Second differences remove level and slope, leaving the noise
    seconds = np.diff(values, 2)
    seconds = seconds[np.isfinite(seconds)]
    if not len(seconds):
        return 0.0
    return (
        NORMAL * float(np.median(np.abs(seconds - np.median(seconds)))) / SECOND_DIFFERENCE_NOISE
    )


def noise_band(pair: AlignedSignals, *, angular: bool = False, doubt: float = 0.0) -> float:
    """
    Return the difference that the noise of two channels explains [unit of the channels].

    `doubt` is the standard deviation of the clock offset [s]; it widens the band by the change of
    the signal in that time.
    """
    a, b = (
        np.unwrap(part) if angular else part for part in select_comparable_values(pair, angular)
    )
    both = math.hypot(noise_deviation(a), noise_deviation(b))
    valid = pair.both_valid
    spread = max(standard_deviation(part[valid], angular) for part in (pair.a, pair.b))
    late = 0.0
    if doubt > 0.0 and valid.sum() > 2:
        step = np.diff(pair.time[valid])
        rate = np.diff(np.unwrap(pair.a[valid]) if angular else pair.a[valid]) / step
        # A clock error shifts the signal by rate times error.
        late = doubt * math.sqrt(float(np.mean(rate**2)))
    return max(SIGMAS * math.hypot(both, late), IRRELEVANT_SHARE * spread)


def select_comparable_values(pair: AlignedSignals, angular: bool) -> tuple[Array, Array]:
    """Return both value arrays; for angles without NaN, because NaN breaks unwrapping."""
    return (pair.a[pair.both_valid], pair.b[pair.both_valid]) if angular else (pair.a, pair.b)


def compute_later_share(time: Array, flags: NDArray[np.bool_], window: float) -> Array:
    """Return the share of set flags within a window [s] from each time on, shape (n,)."""
    ends = np.searchsorted(time, time + window, side='right')
    # Cumulative count, so that each window needs one subtraction
    total = np.concatenate([[0], np.cumsum(flags)])
    here = np.arange(len(time))
    return np.asarray((total[ends] - total[here]) / (ends - here))


def find_divergence(pair: AlignedSignals, band: float, *, by_hand: bool = False) -> Divergence:
    """
    Find when two channels diverge.

    They differ at a time if the difference exceeds the band then and for most of a window that
    begins there: 1 s, ten samples or 2 % of the span, whichever is longest. They diverge at the
    first such time that no window in agreement follows. `band` is half the width. [unit]
    """
    valid = pair.both_valid
    time = pair.time[valid]
    if len(time) < 2:
        return Divergence(band, by_hand, None, None, 0.0)
    outside = np.abs(pair.difference[valid]) > band
    share = float(outside.mean())
    if not outside.any():
        return Divergence(band, by_hand, None, None, 0.0)
    step = float(np.median(np.diff(time)))
    window = max(
        SHORTEST_DIVERGENCE, MIN_DIVERGENT_SAMPLES * step, SPAN_SHARE * float(time[-1] - time[0])
    )
    # More than half of the window must be outside the band.
    most = compute_later_share(time, outside, window) >= 0.5
    # Windows cut off by the end of the recording do not count; half a step covers rounding.
    whole = time + window <= time[-1] + 0.5 * step
    if not whole.any():  # shorter than one window
        whole[0] = True
    apart = outside & most & whole
    first = float(time[apart.argmax()]) if apart.any() else None
    # The last window in agreement; the divergence starts after it.
    together = np.flatnonzero(whole & ~most)
    later = apart & (np.arange(len(time)) > (together[-1] if len(together) else -1))
    at = float(time[later.argmax()]) if later.any() else None
    return Divergence(band, by_hand, at, first, share)
