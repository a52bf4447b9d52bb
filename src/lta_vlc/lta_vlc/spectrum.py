"""The magnitude spectrum of a block of samples, and the bin in which a beacon stands."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray


def target_bin(frequency: float, sample_rate: float, samples: int) -> int:
    """
    Return the bin in which a frequency stands: round(f_mod N_FFT / f_sample), halves up.

    Parameters
    ----------
    frequency : float
        Frequency. [Hz]
    sample_rate : float
        Samples a second. [Hz]
    samples : int
        Samples in the block.

    """
    return math.floor(frequency * samples / sample_rate + 0.5)


def amplitude_spectrum(block: ArrayLike) -> NDArray[np.float64]:
    """
    Return the magnitude of each frequency in a block.

    Parameters
    ----------
    block : array_like, shape (n, d)
        Samples in time order, one column a diode.

    Returns
    -------
    ndarray of float64, shape (n // 2 + 1, d)
        Amplitudes in the unit of the samples; row k is the frequency k f_sample / n.

    Notes
    -----
    Calibrated: a sine of amplitude A in the middle of a bin reads A. The mean is taken out
    before the transform, so row 0 is zero and a constant block reads exactly zero throughout,
    which rounding would spoil. No window, as in the paper: a sine between two bins reads less,
    down to 2/pi of its amplitude, and leaks into its neighbours.

    """
    samples = np.array(np.asarray(block).T, dtype=np.float64, order='C')
    count = samples.shape[1]
    samples -= np.add.reduce(samples, axis=1, keepdims=True) / count  # the mean, in less time
    magnitude = np.abs(np.fft.rfft(samples, axis=1))
    magnitude *= 2.0 / count
    if count % 2 == 0:
        # The highest bin of an even block has no mirror image to share its energy with.
        magnitude[:, -1] *= 0.5
    return magnitude.T
