"""Compute the spectrum of a block of samples and the bin of a beacon."""

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


def fourier_transform(waves: NDArray[np.float64]) -> NDArray[np.complex128]:
    """
    Return the Fourier transform of each diode's wave, without a window, as in the paper.

    Parameters
    ----------
    waves : ndarray of float64, shape (d, n)
        Samples in time order.

    Returns
    -------
    ndarray of complex128, shape (d, n // 2 + 1)
        Times 2/n, so that a sine of amplitude A in the middle of a bin has the magnitude A.

    """
    spectrum = np.fft.rfft(waves, axis=1)
    spectrum *= 2.0 / waves.shape[1]
    return spectrum


def compute_magnitudes(spectrum: NDArray[np.complex128], samples: int) -> NDArray[np.float64]:
    """
    Return the amplitude of each frequency, shape (d, n // 2 + 1).

    Parameters
    ----------
    spectrum : ndarray of complex128, shape (d, n // 2 + 1)
        From `fourier_transform`.
    samples : int
        Samples in the block.

    """
    magnitude = np.abs(spectrum)
    if samples % 2 == 0:
        # The highest bin of an even block has no mirror image to share its energy with.
        magnitude[:, -1] *= 0.5
    return magnitude


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
    Calibrated: a sine of amplitude A in the middle of a bin reads A. A sine between two bins reads
    less, down to 2/pi of its amplitude, and leaks into its neighbours; `lta_vlc.spectral.tone`
    reads it.
    The mean is taken out before the transform, so that row 0 is zero and a constant block reads
    exactly zero throughout, which rounding would spoil.

    """
    waves = np.array(np.asarray(block).T, dtype=np.float64, order='C')
    waves -= np.add.reduce(waves, axis=1, keepdims=True) / waves.shape[1]  # the mean, in less time
    return compute_magnitudes(fourier_transform(waves), waves.shape[1]).T
