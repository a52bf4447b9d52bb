"""Demodulate successive light blocks and track the beacon frequencies."""

from functools import lru_cache
import math

from lta_config.errors import BadInput
from lta_vlc.demodulation import demodulate_block, DemodulatedBlock
from lta_vlc.settings import DemodulationSettings, NO_WISH
from lta_vlc.spectral.bins import BeaconBins, plan_beacon_bins
from lta_vlc.spectral.separation import check_beacons, mains_flicker_frequencies
from lta_vlc.tracker import BeaconPresence, FrequencyTracker, tracking_range
import numpy as np
from numpy.typing import ArrayLike

STEPS = 16  # tracking steps per bin; few steps keep the cache of planned bins small
MOST = 4  # beacons at once; the most recently requested ones are kept


class BeaconReceiver:
    """
    Receive beacons in successive blocks.

    Parameters
    ----------
    sample_rate : float
        Of each diode. [Hz]
    samples : int
        Samples in a block.
    full_scale : float
        The ADC's largest reading; infinite where nothing clips. [counts]

    Raises
    ------
    BadInput
        If a beacon cannot be detected in such blocks, or not be separated from another or the
        mains.

    Attributes
    ----------
    beacons : tuple of float
        Frequencies of the beacons, the wanted one first. [Hz]
    presences : dict of float to BeaconPresence
        Whether each is present.

    """

    def __init__(
        self,
        settings: DemodulationSettings,
        sample_rate: float,
        samples: int,
        full_scale: float = math.inf,
    ) -> None:
        self._settings, self._full_scale = settings, full_scale
        self._shape = sample_rate, samples
        self._width = sample_rate / samples
        # Few combinations of steps occur, so their plans are kept
        self._planned = lru_cache(maxsize=64)(self._plan_bins)
        self._trackers: dict[float, FrequencyTracker] = {}
        self.presences: dict[float, BeaconPresence] = {}
        self.beacons: tuple[float, ...] = ()
        self._check_beacons(settings.beacons)
        self._select_beacons(settings.beacons)

    def _check_beacons(self, beacons: tuple[float, ...]) -> None:
        """Refuse beacons that cannot be received together."""
        plan_beacon_bins(beacons, self._settings, *self._shape)
        check_beacons(beacons, self._settings, *self._shape)

    def _select_beacons(self, beacons: tuple[float, ...]) -> None:
        """Receive these beacons from now on; the state of those already received is kept."""
        self.beacons = beacons
        self._trackers = {one: self._trackers.get(one, FrequencyTracker(one)) for one in beacons}
        self.presences = {one: self.presences.get(one, BeaconPresence()) for one in beacons}
        flicker = mains_flicker_frequencies(self._settings.mains, self._shape[0])
        # Search window and a bin of margin
        apart = (self._settings.window + 1) * self._width
        self._reaches = {one: tracking_range(one, beacons, flicker, apart) for one in beacons}

    def prepare(self) -> None:
        """Compile the demodulation, or load it from disk, before the first block."""
        # Zeros of the right type compile the same code as a real block
        silence = np.zeros((self._shape[1], 1))
        demodulate_block(silence, self._planned(self.beacons, (0,) * len(self.beacons)))

    def prioritize_beacon(self, beacon: float) -> None:
        """
        Put a beacon [Hz] first; the previous ones are still received where possible.

        `NO_WISH` stands for the first beacon of the settings.

        Raise `BadInput` if it cannot be detected or separated from the mains; nothing is changed
        then.
        """
        beacon_first = self._settings.frequency if beacon == NO_WISH else beacon
        before = [one for one in self.beacons if one != beacon_first]
        # Already received: only the order changes
        if len(before) < len(self.beacons):
            self.beacons = (beacon_first, *before)
            return
        beacons: tuple[float, ...] = (beacon_first,)
        self._check_beacons(beacons)
        for one in before[: MOST - 1]:
            try:
                self._check_beacons((*beacons, one))
            except BadInput:
                continue  # it collides with a more recent request
            beacons = (*beacons, one)
        self._select_beacons(beacons)

    def _plan_bins(
        self, beacons: tuple[float, ...], steps: tuple[int, ...]
    ) -> tuple[BeaconBins, ...]:
        """Return the bins of beacons offset from their nominal frequencies by steps."""
        step = self._width / STEPS
        frequencies = [one + number * step for one, number in zip(beacons, steps, strict=True)]
        try:
            return plan_beacon_bins(frequencies, self._settings, *self._shape)
        except BadInput:  # tracked to a frequency that cannot be detected
            return plan_beacon_bins(beacons, self._settings, *self._shape)

    def demodulate_next_block(self, block: ArrayLike) -> DemodulatedBlock:
        """
        Return the results of the next block of ADC counts, shape (n, d), and update the trackers.

        Raise `BadInput` if the block has not the planned shape.
        """
        errors = [self._trackers[one].error for one in self.beacons]
        # Frequency errors in steps of a fraction of a bin
        steps = tuple(round(error * STEPS / self._width) for error in errors)
        hearing = demodulate_block(block, self._planned(self.beacons, steps), self._full_scale)
        for one, peaks, frequency in zip(
            self.beacons, hearing.peaks, hearing.frequencies, strict=True
        ):
            # One diode above the threshold is enough
            is_present = bool(peaks.snr.max() >= self._settings.threshold)
            self.presences[one] = self.presences[one].update_presence(is_present)
            tracker = self._trackers[one]
            self._trackers[one] = (
                tracker.update_frequency(frequency, self._reaches[one])
                if is_present
                else tracker.coast_without_detection()
            )
        return hearing

    def skip_blocks(self, blocks: int) -> None:
        """Update trackers and presences for missing blocks."""
        if blocks > 0:
            self._trackers = {
                one: it.coast_without_detection(blocks) for one, it in self._trackers.items()
            }
            self.presences = {
                one: it.update_presence(False, blocks) for one, it in self.presences.items()
            }
