# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The spectrum of a block of samples: means, amplitudes, and one scan for peaks and noise."""

import math
from typing import NamedTuple

from lta_config.compilation.compiler import compile_kernel
import numpy as np
from numpy.typing import ArrayLike, NDArray


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
