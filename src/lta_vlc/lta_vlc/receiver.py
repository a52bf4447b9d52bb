"""Demodulate successive light blocks and track the beacon frequencies."""

from functools import lru_cache
import math

from lta_config.errors import BadInput
from lta_vlc.beacon_request import NO_WISH
from lta_vlc.demodulation import demodulate_block, DemodulatedBlock
from lta_vlc.presence import BeaconPresence
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.bins import BeaconBins, plan_beacon_bins
from lta_vlc.spectral.separation import check_beacons, mains_flicker_frequencies
from lta_vlc.tracker import FrequencyTracker, tracking_range
import numpy as np
from numpy.typing import ArrayLike

STEPS = 16  # tracking steps per bin; few steps keep the cache of planned bins small
MOST = 4  # beacons at once; the most recently requested ones are kept


class BeaconReceiver:
    """
    Hear the beacons in one block after another.

    Parameters
    ----------
    settings : Demodulation
        The beacons, and how to listen.
    sample_rate : float
        Samples a second of each diode. [Hz]
    samples : int
        Samples in a block.
    full_scale : float
        The ADC's largest reading; infinite where nothing clips. [counts]

    Raises
    ------
    BadInput
        If a beacon cannot be heard in such blocks, or not be told from another or from the mains.

    Attributes
    ----------
    beacons : tuple of float
        The beacons that are listened for, the wanted one first. [Hz]
    presences : dict of float to Presence
        Whether each is found or lost.

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
        self._planned = lru_cache(maxsize=64)(self._plan_bins)
        self._trackers: dict[float, FrequencyTracker] = {}
        self.presences: dict[float, BeaconPresence] = {}
        self.beacons: tuple[float, ...] = ()
        self._check_beacons(settings.beacons)
        self._select_beacons(settings.beacons)

    def _check_beacons(self, beacons: tuple[float, ...]) -> None:
        """Refuse beacons that cannot be heard together."""
        plan_beacon_bins(beacons, self._settings, *self._shape)
        check_beacons(beacons, self._settings, *self._shape)

    def _select_beacons(self, beacons: tuple[float, ...]) -> None:
        """Listen for these from now on; what is known of one that was heard before is kept."""
        self.beacons = beacons
        self._trackers = {one: self._trackers.get(one, FrequencyTracker(one)) for one in beacons}
        self.presences = {one: self.presences.get(one, BeaconPresence()) for one in beacons}
        flicker = mains_flicker_frequencies(self._settings.mains, self._shape[0])
        apart = (self._settings.window + 1) * self._width
        self._reaches = {one: tracking_range(one, beacons, flicker, apart) for one in beacons}

    def prepare(self) -> None:
        """Compile what hears a block, or load it from disk, before the first one waits for it."""
        silence = np.zeros((self._shape[1], 1))
        demodulate_block(silence, self._planned(self.beacons, (0,) * len(self.beacons)))

    def prioritize_beacon(self, beacon: float) -> None:
        """
        Put a beacon first; those of before are listened for besides where they can be.

        Parameters
        ----------
        beacon : float
            Its frequency; `NO_WISH` for the first of the settings. [Hz]

        Raises
        ------
        BadInput
            If it cannot be heard, or not be told from the mains; all stays as it was.

        """
        wanted = self._settings.frequency if beacon == NO_WISH else beacon
        before = [one for one in self.beacons if one != wanted]
        if len(before) < len(self.beacons):
            self.beacons = (wanted, *before)
            return
        kept: tuple[float, ...] = (wanted,)
        self._check_beacons(kept)
        for one in before[: MOST - 1]:
            try:
                self._check_beacons((*kept, one))
            except BadInput:
                continue  # it collides with a more recent request
            kept = (*kept, one)
        self._select_beacons(kept)

    def _plan_bins(
        self, beacons: tuple[float, ...], steps: tuple[int, ...]
    ) -> tuple[BeaconBins, ...]:
        """Return where beacons are sought so many steps from where they should be."""
        step = self._width / STEPS
        found = [one + number * step for one, number in zip(beacons, steps, strict=True)]
        try:
            return plan_beacon_bins(found, self._settings, *self._shape)
        except BadInput:  # tracked to a frequency that cannot be detected
            return plan_beacon_bins(beacons, self._settings, *self._shape)

    def demodulate(self, block: ArrayLike) -> DemodulatedBlock:
        """
        Return what the next block says, and follow the beacons that are heard in it.

        Parameters
        ----------
        block : array_like, shape (n, d)
            Samples in time order, one column a diode: ADC counts.

        Raises
        ------
        BadInput
            If the block is not of the shape that was planned for.

        """
        errors = [self._trackers[one].error for one in self.beacons]
        steps = tuple(round(error * STEPS / self._width) for error in errors)
        hearing = demodulate_block(block, self._planned(self.beacons, steps), self._full_scale)
        for one, peaks, frequency in zip(
            self.beacons, hearing.peaks, hearing.frequencies, strict=True
        ):
            heard = bool(peaks.snr.max() >= self._settings.threshold)
            self.presences[one] = self.presences[one].update(heard)
            tracker = self._trackers[one]
            self._trackers[one] = (
                tracker.update(frequency, self._reaches[one]) if heard else tracker.coast()
            )
        return hearing

    def skip_blocks(self, blocks: int) -> None:
        """Note that blocks have not come."""
        if blocks > 0:
            self._trackers = {one: it.coast(blocks) for one, it in self._trackers.items()}
            self.presences = {one: it.update(False, blocks) for one, it in self.presences.items()}
