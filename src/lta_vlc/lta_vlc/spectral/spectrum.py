# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The spectrum of a block of samples, and the bins in which beacons are sought.

Means, amplitudes, and one scan for peaks and noise. The paper's signal-to-noise ratio is the
beacon's peak over the mean of the quiet bins; beacons have to be apart.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, permutations
import math
from typing import final, NamedTuple, TYPE_CHECKING

from lta_config.compilation.compiler import compile_kernel
from lta_config.errors import BadInput
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from lta_vlc.settings import DemodulationSettings


class SampleStatistics(NamedTuple):
    """Statistics of each diode's samples, arrays of shape (d,)."""

    level: NDArray[np.float64]  # means; NaN for a diode with a NaN or infinite sample
    span: NDArray[np.float64]  # highest sample less the lowest
    full: NDArray[np.float64]  # share of the samples at the upper end of the scale


@compile_kernel
def center_samples(waves: NDArray[np.float64], full_scale: float) -> SampleStatistics:
    """
    Return the statistics of `waves`, shape (d, n), and subtract the means in place.

    Without its mean, bin 0 of a wave is zero and a constant wave is exactly zero throughout,
    despite rounding. The row of a diode with a NaN or infinite sample is set to zero.
    """
    diodes, count = waves.shape
    level, span, full = np.zeros(diodes), np.zeros(diodes), np.zeros(diodes)
    for diode in range(diodes):
        wave = waves[diode]
        total, clipped = 0.0, 0
        lowest = highest = wave[0]
        for k in range(count):
            total += wave[k]
            lowest = min(lowest, wave[k])
            highest = max(highest, wave[k])
            clipped += wave[k] >= full_scale
        mean = total / count
        # One NaN or infinite sample makes the mean so
        sane = np.isfinite(mean)
        for k in range(count):
            wave[k] = wave[k] - mean if sane else 0.0
        level[diode] = mean if sane else np.nan
        span[diode] = highest - lowest
        full[diode] = clipped / count
    return SampleStatistics(level, span, full)


def target_bin(frequency: float, sample_rate: float, samples: int) -> int:
    """Return the bin of a frequency [Hz]: round(f_mod N_FFT / f_sample), halves up."""
    return math.floor(frequency * samples / sample_rate + 0.5)


def fourier_transform(waves: NDArray[np.float64]) -> NDArray[np.complex128]:
    """
    Return the Fourier transform of each row, without a window, as in the paper.

    Shape (d, n // 2 + 1), times 2/n, so that a sine of amplitude A in the middle of a bin has the
    magnitude A.
    """
    spectrum = np.fft.rfft(waves, axis=1)
    # Half of the amplitude of a real wave is at negative frequencies
    spectrum *= 2.0 / waves.shape[1]
    return spectrum


def amplitudes_from_transform(
    spectrum: NDArray[np.complex128], samples: int
) -> NDArray[np.float64]:
    """Return the amplitude of each frequency from `fourier_transform`, shape (d, n // 2 + 1)."""
    magnitude = np.abs(spectrum)
    if samples % 2 == 0:
        # The highest bin of an even block has no mirror image to share its energy with.
        magnitude[:, -1] *= 0.5
    return magnitude


def amplitude_spectrum(block: ArrayLike) -> NDArray[np.float64]:
    """
    Return the amplitudes in a block, shape (n // 2 + 1, d); row k is the frequency k f_sample / n.

    `block` has shape (n, d). A sine of amplitude A in the middle of a bin reads A. A sine between
    two bins reads less, down to 2/pi of its amplitude, and leaks into its neighbours;
    `lta_vlc.spectral.tone` corrects that. The mean is subtracted first, so that row 0 is zero and
    a constant block is exactly zero throughout, despite rounding.
    """
    waves = np.array(np.asarray(block).T, dtype=np.float64, order='C')
    waves -= np.add.reduce(waves, axis=1, keepdims=True) / waves.shape[1]  # the mean, in less time
    return amplitudes_from_transform(fourier_transform(waves), waves.shape[1]).T


class SpectrumScan(NamedTuple):
    """Results of the scan of whole bins."""

    # Strongest bin of each beacon, over all weighted diodes, shape (b,)
    highest: NDArray[np.int64]
    # Magnitude of each diode's highest bin in the search range, shape (b, d)
    peak: NDArray[np.float64]
    # Mean magnitude of the quiet bins, and largest one of the unlit bins, shape (d,)
    noise: NDArray[np.float64]
    loudest: NDArray[np.float64]


@compile_kernel
def scan_spectrum(
    size: NDArray[np.float64],
    ranges: NDArray[np.int64],
    quiet: NDArray[np.int64],
    unlit: NDArray[np.int64],
    weight: NDArray[np.float64],
) -> SpectrumScan:
    """
    Return the peaks and the noise in a spectrum of magnitudes, shape (d, n // 2 + 1).

    `ranges`, shape (b, 2): closed search range of each beacon. `quiet`, `unlit`: quiet bins, and
    those of them without mains flicker. `weight`, shape (d,): 1 for each diode that decides on the
    bin of a beacon, else 0.
    """
    diodes = size.shape[0]
    noise, loudest = np.zeros(diodes), np.zeros(diodes)
    for diode in range(diodes):
        for k in quiet:
            noise[diode] += size[diode, k]
        noise[diode] /= len(quiet)
        for k in unlit:
            loudest[diode] = max(loudest[diode], size[diode, k])
    highest = ranges[:, 0].copy()
    peak = np.zeros((len(ranges), diodes))
    for beacon in range(len(ranges)):
        most = -1.0
        for k in range(ranges[beacon, 0], ranges[beacon, 1] + 1):
            # All diodes decide together where the beacon is, by power
            power = 0.0
            for diode in range(diodes):
                peak[beacon, diode] = max(peak[beacon, diode], size[diode, k])
                power += weight[diode] * size[diode, k] ** 2
            if power > most:
                most, highest[beacon] = power, k
    return SpectrumScan(highest, peak, noise, loudest)


# Of a lamp that is on for half of the time; weaker ones `lta light plan` avoids
STRONG_HARMONICS = (3, 5)
MAINS_HARMONICS = 10  # of the flicker at twice the mains' frequency: those of lamps and dimmers


def mains_flicker_frequencies(mains: float, sample_rate: float) -> list[float]:
    """Return the apparent flicker frequencies of lamps on the mains; `mains` is 0 without [Hz]."""
    orders = range(1, MAINS_HARMONICS + 1) if mains > 0.0 else ()
    return [alias_frequency(2.0 * mains * order, sample_rate) for order in orders]


def alias_frequency(frequency: float, sample_rate: float) -> float:
    """Return the apparent frequency after sampling [Hz]."""
    # Fold into the range from 0 to the Nyquist frequency
    return abs((frequency + sample_rate / 2.0) % sample_rate - sample_rate / 2.0)


def check_beacons(
    beacons: Sequence[float], settings: 'DemodulationSettings', sample_rate: float, samples: int
) -> None:
    """
    Refuse beacons [Hz] that cannot be separated.

    Raise `BadInput` if the search bins of two overlap, or if a strong harmonic of one or the mains
    flicker, possibly aliased, falls into those of another.
    """
    window, width = settings.window, sample_rate / samples
    places = {beacon: target_bin(beacon, sample_rate, samples) for beacon in beacons}
    apart = (2 * window + 1) * width
    for one, other in combinations(beacons, 2):
        # Search windows overlap
        if abs(places[one] - places[other]) <= 2 * window:
            raise BadInput(
                f'The beacons at {one:g} and {other:g} Hz are closer than the resolution '
                f'of {apart:g} Hz; choose other frequencies, longer blocks or a narrower '
                'search window.'
            )
    for one, other in permutations(beacons, 2):
        for order in STRONG_HARMONICS:
            harmonic = target_bin(alias_frequency(order * one, sample_rate), sample_rate, samples)
            if abs(harmonic - places[other]) <= window:
                raise BadInput(
                    f'Harmonic {order} of the beacon at {one:g} Hz falls on the beacon at '
                    f'{other:g} Hz; choose another frequency.'
                )
    for order, flicker in enumerate(
        mains_flicker_frequencies(settings.mains, sample_rate), start=1
    ):
        for beacon in beacons:
            if abs(target_bin(flicker, sample_rate, samples) - places[beacon]) <= window:
                raise BadInput(
                    f'The search window of the beacon at {beacon:g} Hz ({window} bins of '
                    f'{width:g} Hz on either side) contains the flicker of mains lamps at '
                    f'{2.0 * settings.mains * order:g} Hz; choose another frequency or a '
                    'narrower window, or set mains to 0 if there are no such lamps.'
                )


def select_quiet_bins(
    frequencies: Sequence[float], sample_rate: float, samples: int, window: int, harmonics: int
) -> NDArray[np.intp]:
    """
    Return the bins without beacons and their harmonics, in rising order, without bin 0.

    Parameters
    ----------
    frequencies : sequence of float
        Frequencies of all beacons. [Hz]
    sample_rate : float
        Sampling rate. [Hz]
    samples : int
        Samples in a block.
    window : int
        Bins masked on either side of each harmonic.
    harmonics : int
        Harmonics masked, the fundamental included.

    """
    bins = np.arange(samples // 2 + 1)
    # Bin 0 is the mean
    quiet = bins > 0
    for frequency in frequencies:
        for order in range(1, harmonics + 1):
            centre = target_bin(order * frequency, sample_rate, samples)
            # Beyond Nyquist; higher orders are too
            if centre - window > samples // 2:
                break
            quiet[max(0, centre - window) : centre + window + 1] = False
    return np.flatnonzero(quiet)


def signal_to_noise(peak: NDArray[np.float64], noise: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return peak over noise, 0 without any signal and infinity without noise, shape (d,)."""
    # Value where the noise is zero
    silent = np.where(peak > 0.0, np.inf, 0.0)
    return np.divide(peak, noise, out=silent, where=noise > 0.0)


LEAST_QUIET_BINS = 16  # the mean of so many Rayleigh distributed magnitudes is known to 13 %
FLICKER_WIDTH = 1.5  # bins on either side of the flicker of the mains, whose frequency wanders


@final
@dataclass(frozen=True, slots=True)
class BeaconBins:
    """Bins of one beacon in blocks of one length."""

    # Closed range of bins in which its peak is searched
    first: int
    last: int
    # Bins whose mean is the noise: away from the harmonics of every beacon
    quiet: NDArray[np.intp]
    unlit: NDArray[np.intp]  # the quiet bins without mains flicker
    width: float  # width of a bin [Hz]
    samples: int  # samples in a block

    @property
    def frequency_limits(self) -> tuple[float, float]:
        """Lowest and highest frequency whose nearest bin is searched [Hz]."""
        return (self.first - 0.5) * self.width, (self.last + 0.5) * self.width


def plan_beacon_bins(
    beacons: Sequence[float], settings: 'DemodulationSettings', sample_rate: float, samples: int
) -> tuple[BeaconBins, ...]:
    """
    Return the bins of each beacon [Hz] in blocks of a given rate [Hz] and length.

    Raise `BadInput` if a beacon is at or above the Nyquist frequency, too near to zero, or if the
    block is too short to separate it from the harmonics of all.
    """
    block = f'a block of {samples} samples at {sample_rate:g} samples/s'
    width = sample_rate / samples
    ranges = [
        _select_search_range(beacon, settings.window, sample_rate, samples, block)
        for beacon in beacons
    ]
    # Common to all beacons, so that one noise figure serves all
    quiet = select_quiet_bins(beacons, sample_rate, samples, settings.window, settings.harmonics)
    if quiet.size < LEAST_QUIET_BINS:
        raise BadInput(
            f'{_format_beacons(beacons)} and {"its" if len(beacons) == 1 else "their"} '
            f'harmonics leave only {quiet.size} FFT bins of {block} to measure the noise, '
            f'but {LEAST_QUIET_BINS} are needed; use longer blocks, a narrower search window or '
            'fewer harmonics.'
        )
    # Mains flicker in bins
    hum = np.array(mains_flicker_frequencies(settings.mains, sample_rate)) / width
    unlit = quiet[np.abs(quiet[:, None] - hum).min(axis=1, initial=samples) > FLICKER_WIDTH]
    return tuple(BeaconBins(first, last, quiet, unlit, width, samples) for first, last in ranges)


def _format_beacons(beacons: Sequence[float]) -> str:
    """Return the beacons for a message."""
    if len(beacons) == 1:
        return f'The beacon at {beacons[0]:g} Hz'
    return f'The beacons at {", ".join(f"{beacon:g}" for beacon in beacons)} Hz'


def _select_search_range(
    frequency: float, window: int, sample_rate: float, samples: int, block: str
) -> tuple[int, int]:
    """Return the bins in which a beacon is searched, or refuse it."""
    beacon = _format_beacons([frequency])
    if not frequency < sample_rate / 2:
        raise BadInput(
            f'{beacon} cannot be detected at {sample_rate:g} samples/s; sample at more '
            'than twice its frequency.'
        )
    target = target_bin(frequency, sample_rate, samples)
    first, last = target - window, target + window
    if first < 1:
        raise BadInput(
            f'{beacon} is in FFT bin {target} of {block}, too close to zero frequency for '
            f'a search window of {window} bins; use longer blocks or a narrower window.'
        )
    # The highest bin of a real transform
    if last > samples // 2:
        raise BadInput(
            f'{beacon} is in FFT bin {target} of {block}, too close to the Nyquist '
            f'frequency for a search window of {window} bins; sample faster or use a '
            'narrower window.'
        )
    return first, last
