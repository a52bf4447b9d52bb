"""Compute mean and range of each diode, and remove the mean, in one pass."""

from typing import NamedTuple

from lta_vlc.jit import compile_kernel
import numpy as np
from numpy.typing import NDArray


class SampleStatistics(NamedTuple):
    """
    What the samples of each diode are like.

    Attributes
    ----------
    level : ndarray of float64, shape (d,)
        Means; NaN for a diode of which a sample is NaN or infinite.
    span : ndarray of float64, shape (d,)
        Highest sample less the lowest.
    full : ndarray of float64, shape (d,)
        Part of the samples at the upper end of the scale.

    """

    level: NDArray[np.float64]
    span: NDArray[np.float64]
    full: NDArray[np.float64]


@compile_kernel
def center_samples(waves: NDArray[np.float64], full_scale: float) -> SampleStatistics:
    """
    Return what the samples are like, and take the means out of them.

    Without its mean, bin 0 of a wave is zero and a constant wave reads exactly zero throughout,
    which rounding would spoil.

    Parameters
    ----------
    waves : ndarray, shape (d, n)
        Samples in time order, changed in place; zero where one of a diode is NaN or infinite.
    full_scale : float
        The ADC's largest reading, in the unit of the samples.

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
        sane = np.isfinite(mean)
        for k in range(count):
            wave[k] = wave[k] - mean if sane else 0.0
        level[diode] = mean if sane else np.nan
        span[diode] = highest - lowest
        full[diode] = clipped / count
    return SampleStatistics(level, span, full)
