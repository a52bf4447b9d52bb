"""
Compute the crosstalk between lamps in the demodulator.

The wave of each lamp passes the amplifier's pole and the demodulator's spectrum as in the
simulator. Its magnitude in another lamp's search window and in the bins that measure that lamp's
noise is the crosstalk.
"""

from collections.abc import Sequence
import math

from lta_model.light.lamp import NANOSECONDS, SquareWave
from lta_studies.light.plan.polygon import Array
from lta_studies.light.plan.receiver import LightReceiver
from lta_vlc.demodulation import find_peaks, plan_bins
from lta_vlc.spectral.spectrum import amplitude_spectrum
import numpy as np


def compute_crosstalk(
    ear: LightReceiver, frequencies: Sequence[float], duty: float
) -> tuple[Array, Array]:
    """
    Compute the crosstalk of unit waves.

    Parameters
    ----------
    ear : LightReceiver
        Diodes and demodulation.
    frequencies : sequence of float
        Frequencies of the lamps. [Hz]
    duty : float
        Duty cycle of all lamps.

    Returns
    -------
    window, quiet : ndarray, shape (k, k)
        Row i, column j: magnitude of lamp j in the search window of lamp i, and its mean over the
        noise bins of lamp i. Zero on the diagonal.

    """
    rate, samples = ear.light.sample_rate.si, ear.light.samples
    # Sample times in integer nanoseconds, as in the simulator
    times = np.rint(np.arange(samples) * (NANOSECONDS / rate)).astype(np.int64)
    # Time constant of the amplifier's pole [s]
    lag = 1.0 / (2.0 * math.pi * ear.vehicle.diodes.bandwidth)
    waves = np.stack(
        [SquareWave(f, duty).sample_filtered(times, lag) for f in frequencies], axis=1
    )
    spectrum = amplitude_spectrum(waves)
    window, quiet = np.zeros((2, len(frequencies), len(frequencies)))
    for i, frequency in enumerate(frequencies):
        settings = ear.demodulation.model_copy(update={'frequency': frequency})
        bins = plan_bins(settings, rate, samples)
        window[i] = find_peaks(spectrum, bins).amplitude
        # Bins that measure the noise: a wave in them raises the apparent noise.
        quiet[i] = spectrum[bins.quiet].mean(axis=0)
    # A lamp's own wave is signal, not crosstalk.
    np.fill_diagonal(window, 0.0)
    np.fill_diagonal(quiet, 0.0)
    return window, quiet
