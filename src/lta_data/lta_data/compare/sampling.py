"""Resample signals, and compare them at all frequencies; gaps stay gaps."""

from dataclasses import dataclass
from typing import Final, final, NamedTuple

from lta_data.even_grid import (
    BRIDGED_PERIODS,
    find_runs,
    median_period,
    NO_SAMPLES,
    SampledSignal,
)
import numpy as np
from numpy.typing import NDArray
from scipy import signal

FULL_TURN_RADIANS: Final = 2.0 * np.pi
Array = NDArray[np.float64]


def wrap_angle(angle: Array) -> Array:
    """Return angles in [-pi, pi). [rad]"""
    return (angle + np.pi) % FULL_TURN_RADIANS - np.pi


def interpolate_signal(line: SampledSignal, at: Array, *, angular: bool = False) -> Array:
    """
    Interpolate a signal linearly at the times `at`. [s]

    Angular values take the shorter way around. The result is NaN outside the signal, next to
    NaN values, and in gaps.
    """
    time, values = line
    if not len(time):
        return np.full(len(at), np.nan)
    after = np.minimum(np.searchsorted(time, at), len(time) - 1)
    # A sample at exactly the requested time counts even next to a gap or a NaN
    before = np.where(time[after] == at, after, np.maximum(after - 1, 0))
    length = time[after] - time[before]
    step = values[after] - values[before]
    # Along the shorter arc
    step = wrap_angle(step) if angular else step
    value = values[before] + step * (at - time[before]) / np.where(length > 0.0, length, 1.0)
    value = wrap_angle(value) if angular else value
    inside = (at >= time[0]) & (at <= time[-1])
    # Interpolation across a gap would invent data.
    is_known = inside & ~(length > BRIDGED_PERIODS * median_period(time))
    return np.where(is_known, np.where(length > 0.0, value, values[after]), np.nan)


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


def align_signals(a: SampledSignal, b: SampledSignal, *, angular: bool = False) -> AlignedSignals:
    """
    Return two signals at the times of the slower one, on their common span.

    The faster one is interpolated, never across a gap. At equal rates the times of `a` are used.
    """
    if not len(a.time) or not len(b.time):
        return AlignedSignals(NO_SAMPLES, NO_SAMPLES, NO_SAMPLES, NO_SAMPLES)
    # The 0.1 % margin keeps the choice stable when both rates are nominally equal.
    by_a = not median_period(b.time) > median_period(a.time) * (1.0 + 1e-3)
    at = a.time if by_a else b.time
    begin, end = max(a.time[0], b.time[0]), min(a.time[-1], b.time[-1])
    at = at[(at >= begin) & (at <= end)]
    of_a = interpolate_signal(a, at, angular=angular)
    of_b = interpolate_signal(b, at, angular=angular)
    difference = of_b - of_a
    return AlignedSignals(at, of_a, of_b, wrap_angle(difference) if angular else difference)


def break_at_gaps(line: SampledSignal) -> SampledSignal:
    """Insert a NaN into each gap, so that plots do not bridge it."""
    if len(line.time) < 2:
        return line
    steps = np.diff(line.time)
    after = np.flatnonzero(steps > BRIDGED_PERIODS * np.median(steps))
    when = line.time[after] + 0.5 * steps[after]
    return SampledSignal(
        np.insert(line.time, after + 1, when), np.insert(line.values, after + 1, np.nan)
    )


SEGMENT: Final = 1024  # samples per segment, at most
SEGMENTS: Final = 4  # at least, with half overlap
MIN_SPECTRUM_SAMPLES: Final = 32  # samples needed for a spectrum


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


def resample_evenly(pair: AlignedSignals, *, angular: bool = False) -> tuple[Array, Array, Array]:
    """
    Return times and both channels on an even grid over the longest stretch without a gap.

    Angles are unwrapped.
    """
    stretches = find_runs(pair.both_valid)
    if not len(stretches):
        return NO_SAMPLES, NO_SAMPLES, NO_SAMPLES
    part = slice(*stretches[np.ptp(stretches, axis=1).argmax()].tolist())
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
    if count < MIN_SPECTRUM_SAMPLES:
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
