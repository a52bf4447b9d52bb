"""Sort and resample signals; gaps stay gaps."""

from dataclasses import dataclass
from typing import Final, final, NamedTuple

from lta_data.even_grid import median_period
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import signal

GAP: Final = 2.5  # periods without a message that count as a gap
TURN: Final = 2.0 * np.pi
ABSURD: Final = 1e30  # larger than any real value: some drivers write it for 'unknown'
Array = NDArray[np.float64]


class SampledSignal(NamedTuple):
    """Times [s], increasing, and values, both of shape (n,); NaN marks an unknown value."""

    time: Array
    values: Array


def mask_absurd_values(values: ArrayLike) -> Array:
    """Replace infinite and absurdly large values by NaN."""
    numbers = np.asarray(values, dtype=np.float64)
    return np.where(np.abs(numbers) < ABSURD, numbers, np.nan)


def sort_samples(time: ArrayLike, values: ArrayLike) -> SampledSignal:
    """
    Return a signal sorted by time; of several values at one time, the first.

    Samples with a non-finite time are dropped.
    """
    when = np.asarray(time, dtype=np.float64).ravel()
    what = np.asarray(values, dtype=np.float64).ravel()
    usable = np.isfinite(when)
    # np.unique sorts and returns the index of the first occurrence.
    when, first = np.unique(when[usable], return_index=True)
    what = what[usable][first]
    return SampledSignal(when, mask_absurd_values(what))


def wrap_angle(angle: Array) -> Array:
    """Return angles in [-pi, pi). [rad]"""
    return (angle + np.pi) % TURN - np.pi


def interpolate_signal(
    line: SampledSignal, at: Array, *, angular: bool = False, gap: float = GAP
) -> Array:
    """
    Interpolate a signal linearly at the times `at`. [s]

    Angular values take the shorter way around. The result is NaN outside the signal, next to
    NaN values, and between samples more than `gap` median periods apart.
    """
    interpolated = np.full(len(at), np.nan)
    if not len(line.time):
        return interpolated
    right = np.searchsorted(line.time, at)
    # A sample at exactly the requested time counts even next to a gap or a NaN.
    # side='left': an equal time is at index `right`
    exact = right < len(line.time)
    exact[exact] = line.time[right[exact]] == at[exact]
    interpolated[exact] = line.values[right[exact]]
    between = ~exact & (right > 0) & (right < len(line.time))
    j = right[between]
    length = line.time[j] - line.time[j - 1]
    step = line.values[j] - line.values[j - 1]
    # Along the shorter arc
    step = wrap_angle(step) if angular else step
    value = line.values[j - 1] + step * (at[between] - line.time[j - 1]) / length
    value = wrap_angle(value) if angular else value
    # Interpolation across a gap would invent data.
    interpolated[between] = np.where(length > gap * median_period(line.time), np.nan, value)
    return interpolated


class AlignedSignals(NamedTuple):
    """Two signals at the same times."""

    time: Array  # times of the slower signal, shape (n,) [s]
    # Values; NaN where unknown, shape (n,)
    a: Array
    b: Array
    difference: Array  # b minus a; for angles, the shorter way around, shape (n,)

    @property
    def both_valid(self) -> NDArray[np.bool_]:
        """Mask of the times at which both are known."""
        return np.isfinite(self.difference)


def align_signals(
    a: SampledSignal, b: SampledSignal, *, angular: bool = False, gap: float = GAP
) -> AlignedSignals:
    """
    Return two signals at the times of the slower one, on their common span.

    The faster one is interpolated, never across a gap. At equal rates the times of `a` are used.
    """
    if not len(a.time) or not len(b.time):
        nothing = np.empty(0)
        return AlignedSignals(nothing, nothing, nothing, nothing)
    # The 0.1 % margin keeps the choice stable when both rates are nominally equal.
    by_a = not median_period(b.time) > median_period(a.time) * (1.0 + 1e-3)
    at = a.time if by_a else b.time
    begin, end = max(a.time[0], b.time[0]), min(a.time[-1], b.time[-1])
    at = at[(at >= begin) & (at <= end)]
    of_a = interpolate_signal(a, at, angular=angular, gap=gap)
    of_b = interpolate_signal(b, at, angular=angular, gap=gap)
    difference = of_b - of_a
    return AlignedSignals(at, of_a, of_b, wrap_angle(difference) if angular else difference)


def break_at_gaps(line: SampledSignal, gap: float = GAP) -> SampledSignal:
    """Insert a NaN into each gap, so that plots do not bridge it."""
    if len(line.time) < 2:
        return line
    steps = np.diff(line.time)
    after = np.flatnonzero(steps > gap * np.median(steps))
    when = line.time[after] + 0.5 * steps[after]
    return SampledSignal(
        np.insert(line.time, after + 1, when), np.insert(line.values, after + 1, np.nan)
    )


SEGMENT: Final = 1024  # samples per segment, at most
SEGMENTS: Final = 4  # at least, with half overlap
FEWEST: Final = 32  # samples needed for a spectrum


@final
@dataclass(frozen=True, slots=True)
class ChannelSpectra:
    """Power spectra of both channels and of their difference."""

    frequency: Array  # without zero, shape (n,) [Hz]
    # One-sided power spectral density, shape (n,) [unit squared over Hz]
    a: Array
    b: Array
    difference: Array
    coherence: Array  # share of B's power that is linear in A, 0 to 1, shape (n,)
    # Number of averaged segments; unrelated channels have a coherence of about 1 / segments
    segments: int
    # The longest stretch without a gap, from which they are computed [s]
    span: tuple[float, float]


class CorrelationPeak(NamedTuple):
    """Highest correlation of two channels, and the lag of B behind A there. [1, s]"""

    value: float
    lag: float


def resample_evenly(pair: AlignedSignals, *, angular: bool = False) -> tuple[Array, Array, Array]:
    """
    Return times and both channels on an even grid over the longest stretch without a gap.

    Angles are unwrapped.
    """
    valid = pair.both_valid
    # 1 where a stretch of valid samples begins, -1 behind its end
    edges = np.diff(np.concatenate([[0], valid.astype(np.int8), [0]]))
    begins, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    if not len(begins):
        nothing = np.empty(0)
        return nothing, nothing, nothing
    longest = int((ends - begins).argmax())
    part = slice(int(begins[longest]), int(ends[longest]))
    time, a = pair.time[part], pair.a[part]
    a = np.unwrap(a) if angular else a
    # The difference is wrapped already, so B stays on the branch of A
    b = a + pair.difference[part]
    count = len(time)
    if count < 2:
        return time, a, b
    # Even steps, which the FFT needs; stamps jitter
    grid = np.linspace(time[0], time[-1], count)
    return grid, np.interp(grid, time, a), np.interp(grid, time, b)


def compute_spectra(pair: AlignedSignals, *, angular: bool = False) -> ChannelSpectra | None:
    """
    Compute the spectra by Welch's method: Hann windows, half overlapping, mean removed.

    None for fewer than 32 consecutive samples without a gap.
    """
    time, a, b = resample_evenly(pair, angular=angular)
    count = len(time)
    if count < FEWEST:
        return None
    # With half overlap, n segments of length L cover (n + 1) L / 2 samples.
    length = min(SEGMENT, 2 * count // (SEGMENTS + 1))
    rate = (count - 1) / float(time[-1] - time[0])

    def welch_power(values: Array) -> tuple[Array, Array]:
        spectrum: tuple[Array, Array] = signal.welch(values, fs=rate, nperseg=length)
        return spectrum

    frequency, of_a = welch_power(a)
    (_, of_b), (_, of_difference) = welch_power(b), welch_power(b - a)
    # Magnitude-squared coherence: |P_ab|^2 / (P_aa P_bb)
    across = np.abs(signal.csd(a, b, fs=rate, nperseg=length)[1]) ** 2
    power = of_a * of_b
    coherence = np.divide(across, power, out=np.zeros_like(power), where=power > 0.0)
    return ChannelSpectra(
        # The mean was removed, so the value at zero frequency means nothing.
        frequency[1:], of_a[1:], of_b[1:], of_difference[1:],
        np.clip(coherence[1:], 0.0, 1.0), (count - length // 2) // (length - length // 2),
        (float(time[0]), float(time[-1])),
    )  # fmt: skip


def find_correlation_peak(
    pair: AlignedSignals, *, angular: bool = False, longest: float = 5.0
) -> CorrelationPeak | None:
    """
    Return the highest cross-correlation and the lag of B behind A there.

    At each lag only the overlap counts, without its mean; a parabola interpolates between lags.
    The search covers `longest` [s], but at most a quarter of the stretch. None if one channel is
    constant, if there are too few consecutive samples, or if the maximum is at the last lag.
    """
    time, a, b = resample_evenly(pair, angular=angular)
    count = len(time)
    if count < FEWEST or np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return None
    step = float(time[-1] - time[0]) / (count - 1)
    # A quarter of the stretch, so that the overlap stays large.
    most = max(1, min(int(longest / step), count // 4))
    near = lagged_correlation(a - a.mean(), b - b.mean(), most)
    if not np.isfinite(near).any():
        return None
    near = np.nan_to_num(near, nan=-1.0)
    best = int(near.argmax())
    if not 0 < best < len(near) - 1:  # as of a ramp, which resembles itself at any lag
        return None
    shift, value = fit_parabola_peak(near, best)
    return CorrelationPeak(float(np.clip(value, -1.0, 1.0)), (best - most + shift) * step)


def lagged_correlation(a: Array, b: Array, most: int) -> Array:
    """Return the correlation of the overlap at each lag of b, shape (2 most + 1,). [1]"""
    count = len(a)
    lags = np.arange(-most, most + 1)
    # In 'full' mode, lag zero is at index count - 1
    product = signal.correlate(b, a, mode='full', method='fft')[count - 1 + lags]
    size = count - np.abs(lags)
    sums = []
    for part, first in ((a, np.maximum(-lags, 0)), (b, np.maximum(lags, 0))):
        for power in (1, 2):
            # Sums over the overlap at each lag, as differences of cumulative sums
            total = np.concatenate([[0.0], np.cumsum(part**power)])
            sums.append(total[first + size] - total[first])
    of_a, of_aa, of_b, of_bb = sums
    # Product of both variances within the overlap, times size**2
    spread = (of_aa - of_a**2 / size) * (of_bb - of_b**2 / size)
    # Below it the variance is rounding error of the cumulative sums.
    floor = 1e-12 * (float(np.sum(a**2)) * float(np.sum(b**2)))
    correlation = np.full(len(lags), np.nan)
    usable = spread > floor
    shared = product - of_a * of_b / size
    correlation[usable] = shared[usable] / np.sqrt(spread[usable])
    return correlation


def fit_parabola_peak(values: Array, best: int) -> tuple[float, float]:
    """Return position, relative to `best`, and height of the peak of evenly spaced values."""
    if not 0 < best < len(values) - 1:
        return 0.0, float(values[best])
    before, here, after = (float(value) for value in values[best - 1 : best + 2])
    bend = before - 2.0 * here + after
    # Not a maximum: a parabola has no peak here.
    if bend >= 0.0:
        return 0.0, here
    shift = 0.5 * (before - after) / bend
    return shift, here - 0.25 * (before - after) * shift


def average_log_bands(full: ChannelSpectra, points: int = 96) -> ChannelSpectra:
    """Average spectra over logarithmically spaced bands."""
    if len(full.frequency) <= points:
        return full
    edges = np.geomspace(1, len(full.frequency), points + 1)
    # At low frequencies several bands start at one bin; keep it once
    starts = np.unique(np.floor(edges[:-1]).astype(int) - 1)
    sizes = np.diff(np.append(starts, len(full.frequency)))

    def mean(values: Array) -> Array:
        return np.add.reduceat(values, starts) / sizes

    return ChannelSpectra(
        mean(full.frequency), mean(full.a), mean(full.b), mean(full.difference),
        mean(full.coherence), full.segments, full.span,
    )  # fmt: skip
