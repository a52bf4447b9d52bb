"""Compute mean and range of each diode, and remove the mean, in one pass."""

from typing import NamedTuple

from lta_vlc.jit import compile_kernel
import numpy as np
from numpy.typing import NDArray


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
