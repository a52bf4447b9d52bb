"""Select the search bins of each beacon and the quiet bins for the noise."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final, TYPE_CHECKING

from lta_config.errors import BadInput
from lta_vlc.spectral.separation import mains_flicker_frequencies
from lta_vlc.spectral.snr import select_quiet_bins
from lta_vlc.spectral.spectrum import target_bin
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from lta_vlc.settings import DemodulationSettings

QUIET_BINS = 16  # the mean of so many Rayleigh distributed magnitudes is known to 13 %
BESIDE = 1.5  # bins on either side of the flicker of the mains, whose frequency wanders


@final
@dataclass(frozen=True, slots=True)
class BeaconBins:
    """Bins of one beacon in blocks of one length."""

    # Closed range of bins in which its peak is searched
    first: int
    last: int
    # Bins whose mean is the noise: away from the harmonics of every beacon
    quiet: NDArray[np.intp]
    unlit: NDArray[np.intp]  # the quiet bins without mains flicker
    width: float  # width of a bin [Hz]
    samples: int  # samples in a block

    @property
    def frequency_limits(self) -> tuple[float, float]:
        """Lowest and highest frequency whose nearest bin is searched. [Hz]"""
        return (self.first - 0.5) * self.width, (self.last + 0.5) * self.width


def plan_beacon_bins(
    beacons: Sequence[float], settings: 'DemodulationSettings', sample_rate: float, samples: int
) -> tuple[BeaconBins, ...]:
    """
    Return the bins of each beacon [Hz] in blocks of a given rate [Hz] and length.

    Raise `BadInput` if a beacon is at or above the Nyquist frequency, too near to zero, or if the
    block is too short to separate it from the harmonics of all.
    """
    block = f'a block of {samples} samples at {sample_rate:g} samples/s'
    width = sample_rate / samples
    ranges = [
        _select_search_range(beacon, settings.window, sample_rate, samples, block)
        for beacon in beacons
    ]
    # Common to all beacons, so that one noise figure serves all
    quiet = select_quiet_bins(beacons, sample_rate, samples, settings.window, settings.harmonics)
    if quiet.size < QUIET_BINS:
        raise BadInput(
            f'{_format_beacons(beacons)} and {"its" if len(beacons) == 1 else "their"} '
            f'harmonics leave only {quiet.size} FFT bins of {block} to measure the noise, '
            f'but {QUIET_BINS} are needed; use longer blocks, a narrower search window or '
            'fewer harmonics.'
        )
    # Mains flicker in bins
    hum = np.array(mains_flicker_frequencies(settings.mains, sample_rate)) / width
    unlit = quiet[np.abs(quiet[:, None] - hum).min(axis=1, initial=samples) > BESIDE]
    return tuple(BeaconBins(first, last, quiet, unlit, width, samples) for first, last in ranges)


def _format_beacons(beacons: Sequence[float]) -> str:
    """Return the beacons for a message."""
    if len(beacons) == 1:
        return f'The beacon at {beacons[0]:g} Hz'
    return f'The beacons at {", ".join(f"{beacon:g}" for beacon in beacons)} Hz'


def _select_search_range(
    frequency: float, window: int, sample_rate: float, samples: int, block: str
) -> tuple[int, int]:
    """Return the bins in which a beacon is searched, or refuse it."""
    beacon = _format_beacons([frequency])
    if not frequency < sample_rate / 2:
        raise BadInput(
            f'{beacon} cannot be detected at {sample_rate:g} samples/s; sample at more '
            'than twice its frequency.'
        )
    target = target_bin(frequency, sample_rate, samples)
    first, last = target - window, target + window
    if first < 1:
        raise BadInput(
            f'{beacon} is in FFT bin {target} of {block}, too close to zero frequency for '
            f'a search window of {window} bins; use longer blocks or a narrower window.'
        )
    # The highest bin of a real transform
    if last > samples // 2:
        raise BadInput(
            f'{beacon} is in FFT bin {target} of {block}, too close to the Nyquist '
            f'frequency for a search window of {window} bins; sample faster or use a '
            'narrower window.'
        )
    return first, last
