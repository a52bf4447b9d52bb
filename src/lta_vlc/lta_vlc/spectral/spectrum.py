"""Compute the spectrum of a block of samples and the bin of a beacon."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray


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
