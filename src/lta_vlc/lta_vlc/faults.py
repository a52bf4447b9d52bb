"""Detect faults of photodiodes from their samples and spectra."""

from enum import Flag

from lta_vlc.spectral.samples import SampleStatistics
from lta_vlc.spectral.spectrum_scan import SpectrumScan
import numpy as np
from numpy.typing import NDArray

CLIPPED = 0.01  # part of the samples at the end of the scale that spoils a diode
STRANGE = 6.0  # times the mean of the quiet bins: a tone, not noise (5e-13 a bin in white noise)


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


SPOILT = (
    DiodeFault.SATURATED | DiodeFault.FLAT | DiodeFault.NOT_A_NUMBER
)  # the diode cannot be used for any beacon
FAULTS = tuple(map(DiodeFault, range(16)))  # by value


def detect_sample_faults(looked: SampleStatistics) -> NDArray[np.uint8]:
    """Return the faults in each diode's samples, `DiodeFault` values, shape (diodes,)."""
    # `DiodeFault` values as bits of an integer
    faults = np.where(looked.full > CLIPPED, DiodeFault.SATURATED.value, 0)
    faults |= np.where(looked.span == 0.0, DiodeFault.FLAT.value, 0)
    return np.where(np.isnan(looked.level), DiodeFault.NOT_A_NUMBER.value, faults).astype(np.uint8)


def detect_tone_faults(survey: SpectrumScan) -> NDArray[np.uint8]:
    """Return the faults in each diode's spectrum, `DiodeFault` values, shape (diodes,)."""
    # Stronger than every beacon, and far above the noise
    strange = survey.loudest > np.maximum(survey.peak.max(axis=0), STRANGE * survey.noise)
    return np.where(strange, DiodeFault.ALIASED.value, 0).astype(np.uint8)
