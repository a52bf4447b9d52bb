"""Measure the difference of two channels: bias, RMS with a confidence interval, and NRMSE."""

from dataclasses import dataclass
import math
from typing import Final, final

from lta_data.compare.sampling import AlignedSignals, Array, wrap_angle
import numpy as np
from scipy.special import stdtrit

DRAWS: Final = 400  # bootstrap samples
TAIL: Final = 2.5  # percent left on either side of an interval
LONGEST_LAG: Final = 20_000  # samples; bounds the autocorrelation of long recordings
FEWEST: Final = 4  # blocks of the bootstrap, at least
NORMAL: Final = 1.959964  # quantile of the normal distribution for the same tail


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
    correlation = np.fft.irfft(np.abs(spectrum) ** 2)[: min(count, LONGEST_LAG)] / power
    # Integrated autocorrelation time up to each lag, both sides; lag zero counts once
    total = 2.0 * np.cumsum(correlation) - 1.0
    # Sokal's window: stop at five times the estimate, before noise dominates the sum
    inside = np.arange(len(total)) >= 5.0 * total
    return max(1.0, float(total[inside.argmax()] if inside.any() else total.max()))


def rms_interval(
    difference: Array, chance: np.random.Generator, draws: int = DRAWS
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
    # At least FEWEST blocks, or their scatter cannot be estimated.
    most = max(1, count // FEWEST)
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
    few = float(stdtrit(max(blocks - 1, 1), 1.0 - TAIL / 100.0) / NORMAL)
    low, high = np.percentile(apart, [TAIL, 100.0 - TAIL]) * lost * few
    # A mean cannot lie outside the range of the averaged values.
    lowest, highest = math.sqrt(float(squares.min())), math.sqrt(float(squares.max()))
    # 0.5: from the mean square to its root; the interval must contain the estimate
    ends = (math.sqrt(mean) * math.exp(0.5 * end) for end in (min(low, 0.0), max(high, 0.0)))
    first, last = ends
    return max(first, lowest), min(last, highest)
