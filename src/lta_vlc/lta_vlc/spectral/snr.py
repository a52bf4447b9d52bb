"""The paper's signal-to-noise ratio: the beacon's peak over the mean of the quiet bins."""

from collections.abc import Sequence

from lta_vlc.spectral.spectrum import target_bin
import numpy as np
from numpy.typing import NDArray


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
