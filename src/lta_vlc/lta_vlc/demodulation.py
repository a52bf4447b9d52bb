# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Demodulate a block of samples to each diode's peak and signal-to-noise ratio, as in the paper.

The magnitude spectrum of the block is searched for its highest bin within a few bins of
k_target = round(f_mod N_FFT / f_sample); the SNR is its ratio to the mean of all bins outside the
windows around the beacons' harmonics. The paper does not give rate, block length, window and
threshold: they are settings (`lta_vlc.settings`). Additions to the paper: several beacons at once,
and frequency and amplitude between the bins (`lta_vlc.spectral.tone`).
"""

from dataclasses import dataclass
from enum import Flag
import math
from typing import final

from lta_config.errors import BadInput
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.spectrum import (
    amplitudes_from_transform,
    BeaconBins,
    center_samples,
    fourier_transform,
    plan_beacon_bins,
    SampleStatistics,
    scan_spectrum,
    signal_to_noise,
    SpectrumScan,
)
from lta_vlc.spectral.tone import estimate_tones
import numpy as np
from numpy.typing import ArrayLike, NDArray

CLIPPED_SHARE = 0.01  # part of the samples at the end of the scale that spoils a diode
# By the mean of the quiet bins: a tone, not noise (5e-13 a bin in white noise)
UNKNOWN_TONE = 6.0


class DiodeFault(Flag):
    """
    Faults of one diode in one block; several may hold at once.

    Attributes
    ----------
    SATURATED
        More than `CLIPPED` of the samples are at the upper end of the ADC's scale: peaks are cut,
        and the amplitude is too low by an unknown amount.
    FLAT
        All samples are equal: a dead diode or a broken wire.
    NOT_A_NUMBER
        A sample is NaN or infinite.
    ALIASED
        An unknown tone is stronger than every beacon: a lamp of another frequency, or one beyond
        the Nyquist frequency, folded back. The beacons can still be read.

    """

    NONE = 0
    SATURATED = 1
    FLAT = 2
    NOT_A_NUMBER = 4
    ALIASED = 8


UNUSABLE_FAULTS = (
    DiodeFault.SATURATED | DiodeFault.FLAT | DiodeFault.NOT_A_NUMBER
)  # the diode cannot be used for any beacon
FAULTS_BY_VALUE = tuple(map(DiodeFault, range(16)))  # by value


def detect_sample_faults(looked: SampleStatistics) -> NDArray[np.uint8]:
    """Return the faults in each diode's samples, `DiodeFault` values, shape (diodes,)."""
    # `DiodeFault` values as bits of an integer
    faults = np.where(looked.full > CLIPPED_SHARE, DiodeFault.SATURATED.value, 0)
    faults |= np.where(looked.span == 0.0, DiodeFault.FLAT.value, 0)
    return np.where(np.isnan(looked.level), DiodeFault.NOT_A_NUMBER.value, faults).astype(np.uint8)


def detect_tone_faults(survey: SpectrumScan) -> NDArray[np.uint8]:
    """Return the faults in each diode's spectrum, `DiodeFault` values, shape (diodes,)."""
    # Stronger than every beacon, and far above the noise
    strange = survey.loudest > np.maximum(survey.peak.max(axis=0), UNKNOWN_TONE * survey.noise)
    return np.where(strange, DiodeFault.ALIASED.value, 0).astype(np.uint8)


@final
@dataclass(frozen=True, slots=True)
class Peaks:
    """Readings of one beacon by each diode, arrays of shape (d,)."""

    # Amplitude of the beacon's fundamental, in the unit of the samples
    amplitude: NDArray[np.float64]
    snr: NDArray[np.float64]  # highest bin over the mean of the quiet bins; 0 for a spoilt diode
    frequency: NDArray[np.float64]  # peak frequency of each diode alone [Hz]
    # Mean magnitude of the quiet bins, in the unit of the samples. White noise of this mean moves
    # an amplitude by sqrt(2/pi) of it, one standard deviation.
    noise: NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class DemodulatedBlock:
    """Results of one block."""

    peaks: tuple[Peaks, ...]  # of each beacon, the wanted one first
    frequencies: tuple[float, ...]  # of each beacon, common to all diodes [Hz]
    faults: tuple[DiodeFault, ...]  # of each diode
    # Mean of each diode: steady light, in the unit of the samples, shape (d,)
    level: NDArray[np.float64]


def find_peaks(spectrum: NDArray[np.float64], bins: BeaconBins) -> Peaks:
    """
    Return each diode's peak and SNR for one beacon by whole bins, as in the paper.

    `spectrum` holds the amplitudes from `amplitude_spectrum`, shape (n // 2 + 1, d).
    """
    searched = spectrum[bins.first : bins.last + 1]
    highest, peak = searched.argmax(axis=0), searched.max(axis=0)
    noise = spectrum[bins.quiet].mean(axis=0)
    frequency = (bins.first + highest) * bins.width
    return Peaks(peak, signal_to_noise(peak, noise), frequency, noise)


def demodulate_block(
    block: ArrayLike, beacons: tuple[BeaconBins, ...], full_scale: float = math.inf
) -> DemodulatedBlock:
    """
    Return the results of one block for each beacon and each diode.

    `block`, shape (n, d): samples in time order, one column a diode: ADC counts or any linear
    unit. `beacons`: bins of the beacons, all with the same quiet bins. `full_scale`: the ADC's
    largest reading, in the unit of the samples. Raise `BadInput` if the block is not
    two-dimensional or has not the planned length.
    """
    bins, samples = beacons[0], np.asarray(block)
    if samples.ndim != 2 or samples.shape[0] != bins.samples or samples.shape[1] == 0:
        raise BadInput(
            f'A block of photodiode samples has the shape {samples.shape}, but the '
            f'demodulator expects {bins.samples} samples of each diode; set the same block '
            'length in the light board and the demodulator.'
        )
    # A contiguous row for each diode, as the transform reads it
    waves = np.array(samples.T, dtype=np.float64, order='C')
    looked = center_samples(waves, full_scale)
    faults = detect_sample_faults(looked)
    # Spoilt diodes must not influence the common frequency
    sound = (faults & UNUSABLE_FAULTS.value) == 0
    weight = sound.astype(np.float64)
    spectrum = fourier_transform(waves)
    size = amplitudes_from_transform(spectrum, bins.samples)
    ranges = np.array([(one.first, one.last) for one in beacons])
    scan = scan_spectrum(size, ranges, bins.quiet, bins.unlit, weight)
    # Only now: it needs the spectrum
    faults |= detect_tone_faults(scan)
    # 0 marks a diode that later stages leave out
    snr = np.where(sound, signal_to_noise(scan.peak, scan.noise), 0.0)
    tones = estimate_tones(spectrum, scan.highest, weight, bins.samples)
    return DemodulatedBlock(
        tuple(
            Peaks(*one, scan.noise)
            for one in zip(tones.amplitude, snr, tones.own * bins.width, strict=True)
        ),
        tuple((tones.frequency * bins.width).tolist()),
        tuple(FAULTS_BY_VALUE[fault] for fault in faults.tolist()),
        looked.level,
    )


def plan_bins(settings: DemodulationSettings, sample_rate: float, samples: int) -> BeaconBins:
    """Return where the first beacon alone stands, at a rate in Hz; see `plan_beacon_bins`."""
    return plan_beacon_bins((settings.frequency,), settings, sample_rate, samples)[0]


def demodulate_beacon(block: ArrayLike, bins: BeaconBins) -> Peaks:
    """Return peaks of one beacon in a block, shape (samples, diodes); see `demodulate_block`."""
    return demodulate_block(block, (bins,)).peaks[0]
