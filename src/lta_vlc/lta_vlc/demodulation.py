"""
From a block of samples to each diode's peak and signal-to-noise ratio, as the paper does it.

The magnitude spectrum of the block is searched for its highest bin within a few bins of
k_target = round(f_mod N_FFT / f_sample); its ratio to the mean of all bins outside the windows
around the beacon's harmonics is the SNR. The paper prints neither rate, block length, window nor
threshold: they are settings here.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import final

from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_vlc.snr import quiet_bins, signal_to_noise
from lta_vlc.spectrum import amplitude_spectrum, target_bin
import numpy as np
from numpy.typing import ArrayLike, NDArray

NO_WISH = 0.0  # Hz, of a beacon: the one of the settings
QUIET_BINS = 16  # the mean of so many Rayleigh distributed magnitudes is known to 13 %


@final
class Demodulation(Settings):
    """
    Which beacon to listen for, and how.

    In white noise alone a diode passes the threshold T in a share (2 window + 1) exp(-pi T^2 / 4)
    of the blocks: 0.4 % at T = 3 and a window of 2, never at 6, which leaves room for noise that
    is not white.
    """

    frequency: float = setting(
        150.0, 'Frequency at which the beacon flickers', unit='Hz', low=1.0, high=100_000.0
    )
    window: int = setting(
        2, 'Bins searched and masked on either side of a harmonic', unit='1', low=0, high=100
    )
    harmonics: int = setting(
        50, 'Harmonics kept out of the noise, the fundamental included', unit='1', low=1, high=1000
    )
    threshold: float = setting(
        6.0, 'SNR from which a diode is believed', unit='1', low=1.0, high=1000.0
    )


@final
@dataclass(frozen=True, slots=True)
class Peaks:
    """
    What each diode sees of one beacon.

    Parameters
    ----------
    amplitude : ndarray of float64, shape (d,)
        Amplitude of the beacon's fundamental, in the unit of the samples.
    snr : ndarray of float64, shape (d,)
        Peak over the mean of the quiet bins; 0 for a flat line.
    frequency : ndarray of float64, shape (d,)
        Frequency of the bin in which the peak stands. [Hz]

    """

    amplitude: NDArray[np.float64]
    snr: NDArray[np.float64]
    frequency: NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class Bins:
    """
    Where one beacon is looked for in blocks of one length.

    Parameters
    ----------
    first, last : int
        Closed range of bins in which its peak is sought.
    quiet : ndarray of int
        Bins whose mean is the noise.
    width : float
        Width of a bin. [Hz]
    samples : int
        Samples in a block.

    """

    first: int
    last: int
    quiet: NDArray[np.intp]
    width: float
    samples: int


@lru_cache(maxsize=64)
def bins_of(settings: Demodulation, beacon: float, sample_rate: float, samples: int) -> Bins:
    """
    Return where a beacon is looked for, `NO_WISH` being that of the settings; see `plan_bins`.

    Whoever flies a route asks for one beacon after the other.
    """
    wanted = settings if beacon == NO_WISH else settings.model_copy(update={'frequency': beacon})
    return plan_bins(wanted, sample_rate, samples)


def plan_bins(settings: Demodulation, sample_rate: float, samples: int) -> Bins:
    """
    Return where a beacon stands in blocks of a given rate and length.

    Parameters
    ----------
    settings : Demodulation
        The beacon.
    sample_rate : float
        Samples a second of each diode. [Hz]
    samples : int
        Samples in a block.

    Raises
    ------
    BadInput
        If the beacon is at or above the Nyquist frequency, too near to zero, or if the block is
        too short to tell it from its harmonics.

    """
    beacon = f'The beacon at {settings.frequency:g} Hz'
    if not settings.frequency < sample_rate / 2:
        raise BadInput(
            f'{beacon} cannot be seen at {sample_rate:g} samples/s; sample at more than twice '
            'its frequency.'
        )
    target = target_bin(settings.frequency, sample_rate, samples)
    first, last = target - settings.window, target + settings.window
    block = f'a block of {samples} samples at {sample_rate:g} samples/s'
    if first < 1:
        raise BadInput(
            f'{beacon} stands in bin {target} of {block}, too near to zero for a window of '
            f'{settings.window} bins; take longer blocks or a narrower window.'
        )
    if last > samples // 2:
        raise BadInput(
            f'{beacon} stands in bin {target} of {block}, too near to the Nyquist frequency for '
            f'a window of {settings.window} bins; sample faster or narrow the window.'
        )
    quiet = quiet_bins(
        settings.frequency, sample_rate, samples, settings.window, settings.harmonics
    )
    if quiet.size < QUIET_BINS:
        raise BadInput(
            f'{beacon} and its harmonics leave {quiet.size} bins of {block} to measure the noise '
            f'in, but {QUIET_BINS} are needed; take longer blocks or a narrower window.'
        )
    return Bins(first, last, quiet, sample_rate / samples, samples)


def find_peaks(spectrum: NDArray[np.float64], bins: Bins) -> Peaks:
    """
    Return each diode's peak and SNR for one beacon.

    Parameters
    ----------
    spectrum : ndarray of float64, shape (n // 2 + 1, d)
        Amplitudes from `amplitude_spectrum`.
    bins : Bins
        Where the beacon stands.

    """
    searched = spectrum[bins.first : bins.last + 1]
    highest, peak = searched.argmax(axis=0), searched.max(axis=0)
    # The mean of the quiet bins, each diode's next to each other: a third of the time.
    noise = np.add.reduce(spectrum.T.take(bins.quiet, axis=1), axis=1) / bins.quiet.size
    return Peaks(peak, signal_to_noise(peak, noise), (bins.first + highest) * bins.width)


def demodulate(block: ArrayLike, bins: Bins) -> Peaks:
    """
    Return what each diode sees of a beacon in one block.

    Parameters
    ----------
    block : array_like, shape (n, d)
        Samples in time order, one column a diode: ADC counts or any linear unit.
    bins : Bins
        Where the beacon stands in such a block.

    Raises
    ------
    BadInput
        If the block is not two-dimensional or not of the length that `bins` was planned for.

    """
    shape = np.shape(block)
    if len(shape) != 2 or shape[0] != bins.samples:
        raise BadInput(
            f'A light block has the shape {shape}, but {bins.samples} samples by diodes are '
            'expected; give both ends the same block length.'
        )
    return find_peaks(amplitude_spectrum(block), bins)
