"""Measure how much two channels differ, and find when: from when on by more than their noise."""

from dataclasses import dataclass
import math
from typing import Final, final

from lta_data.compare.sampling import AlignedSignals, Array, wrap_angle
import numpy as np
from scipy.special import stdtrit

BOOTSTRAP_DRAWS: Final = 400  # bootstrap samples
TAIL_PERCENT: Final = 2.5  # percent left on either side of an interval
AUTOCORRELATION_SAMPLES: Final = 20_000  # samples; bounds the autocorrelation of long recordings
FEWEST_BLOCKS: Final = 4  # blocks of the bootstrap, at least
NORMAL_QUANTILE: Final = 1.959964  # quantile of the normal distribution for the same tail


@final
@dataclass(frozen=True, slots=True)
class DifferenceMeasures:
    """The difference of two channels, B minus A, on their common span."""

    count: int  # instants at which both values are known
    # Mean and root mean square [unit of the channel]
    bias: float
    rms: float
    # 95 % interval of `rms` by block bootstrap
    rms_low: float
    rms_high: float
    # The largest difference in magnitude, and its time [unit; s]
    greatest: float
    greatest_at: float
    spread: float  # standard deviation of A at the same instants
    nrmse: float | None  # rms / spread; None if A is constant


def measure_difference(
    pair: AlignedSignals, *, angular: bool = False, seed: int = 0
) -> DifferenceMeasures | None:
    """
    Return the measures of two channels; None if they have no common valid sample.

    For angular channels, the spread of A is taken about its mean direction. `seed` is the random
    seed of the bootstrap.
    """
    valid = pair.both_valid
    if not valid.any():
        return None
    difference, time, a = pair.difference[valid], pair.time[valid], pair.a[valid]
    most = int(np.abs(difference).argmax())
    rms = math.sqrt(float(np.mean(difference**2)))
    low, high = rms_interval(difference, np.random.default_rng(seed))
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
    # Zero padding, so that the circular correlation of the FFT does not wrap around.
    spectrum = np.fft.rfft(centred, 1 << (2 * count - 1).bit_length())
    correlation = (
        np.fft.irfft(np.abs(spectrum) ** 2)[: min(count, AUTOCORRELATION_SAMPLES)] / power
    )
    # Integrated autocorrelation time up to each lag, both sides; lag zero counts once
    total = 2.0 * np.cumsum(correlation) - 1.0
    # Sokal's window: stop at five times the estimate, before noise dominates the sum
    inside = np.arange(len(total)) >= 5.0 * total
    return max(1.0, float(total[inside.argmax()] if inside.any() else total.max()))


def rms_interval(
    difference: Array, chance: np.random.Generator, draws: int = BOOTSTRAP_DRAWS
) -> tuple[float, float]:
    """
    Return the 95 % interval of the RMS of an autocorrelated series.

    Circular block bootstrap (Politis and Romano 1992): blocks of the squares, five times as long
    as their autocorrelation time, are drawn with replacement. The percentiles are those of the
    logarithm of the draws. They are widened for the correlation lost at the block ends, and by
    Student's t for the small number of blocks.
    """
    squares = difference**2
    count, mean = len(squares), float(np.mean(squares))
    if count < 2 or np.ptp(squares) == 0.0 or mean == 0.0:
        return math.sqrt(mean), math.sqrt(mean)
    # Blocks must be longer than the memory of the series to be independent.
    alike = autocorrelation_time(squares)
    # At least FEWEST_BLOCKS blocks, or their scatter cannot be estimated.
    most = max(1, count // FEWEST_BLOCKS)
    length = min(math.ceil(max(5.0 * alike, count ** (1 / 3))), most)
    blocks = -(-count // length)  # rounded up
    # Cumulative sums of the wrapped series: the sum of any block is one subtraction.
    around = np.concatenate([[0.0], np.cumsum(np.concatenate([squares, squares[:length]]))])
    starts = chance.integers(0, count, size=(draws, blocks))
    means = (around[starts + length] - around[starts]).sum(axis=1) / (blocks * length)
    # In logarithms, since a mean square is positive and its distribution is skewed
    apart = np.log(np.maximum(means, 1e-300) / mean)
    # Correlation across the block ends is lost, and few blocks estimate their scatter poorly.
    lost = math.sqrt(1.0 / (1.0 - min(0.5, alike / length)))
    few = float(stdtrit(max(blocks - 1, 1), 1.0 - TAIL_PERCENT / 100.0) / NORMAL_QUANTILE)
    low, high = np.percentile(apart, [TAIL_PERCENT, 100.0 - TAIL_PERCENT]) * lost * few
    # A mean cannot lie outside the range of the averaged values.
    lowest, highest = math.sqrt(float(squares.min())), math.sqrt(float(squares.max()))
    # 0.5: from the mean square to its root; the interval must contain the estimate
    ends = (math.sqrt(mean) * math.exp(0.5 * end) for end in (min(low, 0.0), max(high, 0.0)))
    first, last = ends
    return max(first, lowest), min(last, highest)


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
    Return the difference that the noise of two channels explains. [unit of the channels]

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
    ends = np.searchsorted(time, time + window, side='right')
    # Cumulative count, so that each window needs one subtraction
    total = np.concatenate([[0], np.cumsum(outside)])
    here = np.arange(len(time))
    # More than half of the window must be outside the band.
    most = (total[ends] - total[here]) * 2 >= ends - here
    # Windows cut off by the end of the recording do not count; half a step covers rounding.
    whole = time + window <= time[-1] + 0.5 * step
    if not whole.any():  # shorter than one window
        whole[0] = True
    apart = outside & most & whole
    first = float(time[apart.argmax()]) if apart.any() else None
    # The last window in agreement; the divergence starts after it.
    together = np.flatnonzero(whole & ~most)
    later = apart & (here > (together[-1] if len(together) else -1))
    at = float(time[later.argmax()]) if later.any() else None
    return Divergence(band, by_hand, at, first, share)
