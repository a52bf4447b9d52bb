"""How far two channels are apart: bias, RMS with its interval, and the RMS beside the spread."""

from dataclasses import dataclass
import math
from typing import Final, final

from lta_data.compare.sampling import AlignedSignals, Array, wrap_angle
import numpy as np
from scipy.special import stdtrit

DRAWS: Final = 400
TAIL: Final = 2.5  # percent left on either side of an interval
LONGEST_LAG: Final = 20_000
FEWEST: Final = 4  # blocks
NORMAL: Final = 1.959964  # the same tail of a normal distribution


@final
@dataclass(frozen=True, slots=True)
class DifferenceMeasures:
    """
    The difference of two channels, B minus A, on their common span.

    Attributes
    ----------
    count : int
        Instants at which both are known.
    bias, rms : float
        Mean and root mean square. [unit of the channel]
    rms_low, rms_high : float
        95 % interval of `rms` by block bootstrap.
    greatest, greatest_at : float
        The difference of most size, and when. [unit; s]
    spread : float
        Standard deviation of A at the same instants.
    nrmse : float or None
        rms / spread; None where A stands still.

    """

    count: int
    bias: float
    rms: float
    rms_low: float
    rms_high: float
    greatest: float
    greatest_at: float
    spread: float
    nrmse: float | None


def measure_difference(
    pair: AlignedSignals, *, angular: bool = False, seed: int = 0
) -> DifferenceMeasures | None:
    """
    Return how far two channels are apart; None where they are never known together.

    Parameters
    ----------
    pair : Aligned
        The two channels.
    angular : bool
        Whether values 2 pi apart mean the same; the spread of A is then that about its mean
        direction.
    seed : int
        Of the bootstrap's draws.

    """
    known = pair.both_valid
    if not known.any():
        return None
    difference, time, a = pair.difference[known], pair.time[known], pair.a[known]
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
    """Return the standard deviation of finite values, in their unit; zero where all are equal."""
    if not len(values) or np.ptp(values) == 0.0:
        return 0.0
    if angular:
        middle = math.atan2(float(np.mean(np.sin(values))), float(np.mean(np.cos(values))))
        return float(np.std(wrap_angle(values - middle)))
    return float(np.std(values))


def autocorrelation_time(values: Array) -> float:
    """
    Return the integrated autocorrelation time in samples: 1 for white noise.

    Summed until the sum's own window of five times it is reached (Sokal 1997, "Monte Carlo
    methods in statistical mechanics").
    """
    centred = values - values.mean()
    count = len(centred)
    power = float(np.dot(centred, centred))
    if count < 4 or power == 0.0:
        return 1.0
    spectrum = np.fft.rfft(centred, 1 << (2 * count - 1).bit_length())
    correlation = np.fft.irfft(np.abs(spectrum) ** 2)[: min(count, LONGEST_LAG)] / power
    total = 2.0 * np.cumsum(correlation) - 1.0
    inside = np.arange(len(total)) >= 5.0 * total
    return max(1.0, float(total[inside.argmax()] if inside.any() else total.max()))


def rms_interval(
    difference: Array, chance: np.random.Generator, draws: int = DRAWS
) -> tuple[float, float]:
    """
    Return the 95 % interval of the RMS of a series whose neighbours resemble each other.

    Circular block bootstrap (Politis and Romano 1992): whole blocks of the squares, several times
    as long as their memory, are drawn with replacement; percentiles of the draws' logarithm,
    widened for what blocks lose at their ends and for how few they are (Student's t).

    Parameters
    ----------
    difference : ndarray, shape (n,)
        Finite.
    chance : Generator
        The draws.
    draws : int
        How many.

    """
    squares = difference**2
    count, mean = len(squares), float(np.mean(squares))
    if count < 2 or np.ptp(squares) == 0.0 or mean == 0.0:
        return math.sqrt(mean), math.sqrt(mean)
    alike = autocorrelation_time(squares)
    most = max(1, count // FEWEST)
    length = min(math.ceil(max(5.0 * alike, count ** (1 / 3))), most)
    blocks = -(-count // length)
    around = np.concatenate([[0.0], np.cumsum(np.concatenate([squares, squares[:length]]))])
    starts = chance.integers(0, count, size=(draws, blocks))
    means = (around[starts + length] - around[starts]).sum(axis=1) / (blocks * length)
    apart = np.log(np.maximum(means, 1e-300) / mean)
    # Cut at the ends of blocks, resemblance is lost; and few blocks tell their own scatter badly.
    lost = math.sqrt(1.0 / (1.0 - min(0.5, alike / length)))
    few = float(stdtrit(max(blocks - 1, 1), 1.0 - TAIL / 100.0) / NORMAL)
    low, high = np.percentile(apart, [TAIL, 100.0 - TAIL]) * lost * few
    # No mean lies beyond what was averaged.
    lowest, highest = math.sqrt(float(squares.min())), math.sqrt(float(squares.max()))
    ends = (math.sqrt(mean) * math.exp(0.5 * end) for end in (min(low, 0.0), max(high, 0.0)))
    first, last = ends
    return max(first, lowest), min(last, highest)
