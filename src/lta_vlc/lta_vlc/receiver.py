# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Demodulate successive light blocks: their order, the beacons present, and their frequencies."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
import math
from typing import final, NamedTuple

from lta_config.errors import BadInput
from lta_vlc.demodulation import demodulate_block, DemodulatedBlock
from lta_vlc.settings import ANY_BEACON, DemodulationSettings
from lta_vlc.spectral.spectrum import (
    BeaconBins,
    check_beacons,
    mains_flicker_frequencies,
    plan_beacon_bins,
)
import numpy as np
from numpy.typing import ArrayLike

FREQUENCY_GAIN = 0.25  # gain of the low-pass filter on the measured frequency
CLOCK_ERROR_LIMIT = 0.05  # largest clock error that is tracked, relative to the frequency
SILENT_BLOCKS = 20  # blocks without the beacon after which the search returns to the nominal
BLOCKS_TO_FIND = 2  # blocks in a row with the beacon after which it is found
BLOCKS_TO_LOSE = 5  # blocks in a row without it after which it is lost


@final
@dataclass(frozen=True, slots=True)
class FrequencyTracker:
    """Expected frequency of a beacon in the next block."""

    # Nominal frequency, and estimated deviation from it [Hz]
    nominal: float
    error: float = 0.0
    silent: int = 0  # blocks since it was last detected

    def update_frequency(self, frequency: float, reach: float) -> 'FrequencyTracker':
        """Return the tracker after a detection; `reach` limits the deviation [Hz]."""
        # First-order low pass
        error = self.error + FREQUENCY_GAIN * (frequency - self.nominal - self.error)
        return FrequencyTracker(self.nominal, min(max(error, -reach), reach))

    def coast_without_detection(self, blocks: int = 1) -> 'FrequencyTracker':
        """Return the tracker after blocks without the beacon."""
        silent = self.silent + blocks
        return replace(self, error=0.0 if silent >= SILENT_BLOCKS else self.error, silent=silent)


def tracking_range(
    beacon: float, beacons: Sequence[float], flicker: Sequence[float], apart: float
) -> float:
    """
    Return how far a beacon may be tracked without entering the bins of another [Hz].

    `apart` is half the width of the search range; `flicker` are the frequencies of mains lamps.
    """
    # Two beacons may each move half of the way
    ways = [0.5 * abs(other - beacon) - apart for other in beacons if other != beacon]
    ways += [abs(other - beacon) - apart for other in flicker]
    return max(0.0, min([CLOCK_ERROR_LIMIT * beacon, *ways]))


class BeaconPresence(NamedTuple):
    """Whether a beacon is present, and the number of consecutive blocks that contradict it."""

    found: bool = False
    against: int = 0

    def update_presence(self, detected: bool, blocks: int = 1) -> 'BeaconPresence':
        """Return the presence after blocks with or without the beacon."""
        # Confirmed: the count of contradicting blocks restarts
        if detected == self.found:
            return BeaconPresence(self.found)
        against = self.against + blocks
        enough = BLOCKS_TO_FIND if detected else BLOCKS_TO_LOSE
        return (
            BeaconPresence(detected) if against >= enough else BeaconPresence(self.found, against)
        )


# Blocks by which time goes back when it begins anew, as in a recording played again
REWIND_BLOCKS = 10


class BlockSequence:
    """
    The blocks of one array in time order.

    `period_ns`: from the first sample of a block to that of the next [ns]. Attribute `missing`:
    number of missing blocks so far.
    """

    def __init__(self, period_ns: int) -> None:
        self._period = period_ns
        self._newest: int | None = None
        self.missing = 0

    def count_missing_blocks(self, stamp_ns: int) -> int:
        """
        Return how many blocks are missing before the one whose first sample has this stamp [ns].

        Raise `BadInput` if it is older than the newest one, or overlaps with it by more than half.
        """
        before, period = self._newest, self._period
        # First block, or a recording that starts again
        if before is None or stamp_ns <= before - REWIND_BLOCKS * period:
            self._newest = stamp_ns
            return 0
        gap = stamp_ns - before
        if 2 * gap < period:
            raise BadInput(
                f'A block of photodiode samples with the time stamp {stamp_ns * 1e-9:.3f} '
                f's follows one with {before * 1e-9:.3f} s, but each block lasts '
                f'{period * 1e-9:g} s; send each block once, in time order.'
            )
        self._newest = stamp_ns
        # Rounded to whole periods
        missing = (gap + period // 2) // period - 1
        self.missing += missing
        return missing


STEPS_PER_BIN = 16  # tracking steps per bin; few steps keep the cache of planned bins small
MAX_BEACONS = 4  # beacons at once; the most recently requested ones are kept


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
        beacon_first = self._settings.frequency if beacon == ANY_BEACON else beacon
        before = [one for one in self.beacons if one != beacon_first]
        # Already received: only the order changes
        if len(before) < len(self.beacons):
            self.beacons = (beacon_first, *before)
            return
        beacons: tuple[float, ...] = (beacon_first,)
        self._check_beacons(beacons)
        for one in before[: MAX_BEACONS - 1]:
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
        step = self._width / STEPS_PER_BIN
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
        steps = tuple(round(error * STEPS_PER_BIN / self._width) for error in errors)
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
