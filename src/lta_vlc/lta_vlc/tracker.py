"""Track a beacon over blocks: its frequency, for lamps with clock error or drift, and presence."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final, NamedTuple

PULL = 0.25  # gain of the low-pass filter on the measured frequency
REACH = 0.05  # largest clock error that is tracked, relative to the frequency
PATIENCE = 20  # blocks without the beacon after which the search returns to the nominal
FOUND = 2  # blocks in a row with the beacon after which it is found
LOST = 5  # blocks in a row without it after which it is lost


@final
@dataclass(frozen=True, slots=True)
class FrequencyTracker:
    """Expected frequency of a beacon in the next block."""

    # Nominal frequency, and estimated deviation from it [Hz]
    nominal: float
    error: float = 0.0
    silent: int = 0  # blocks since it was last detected

    def update_frequency(self, frequency: float, reach: float) -> 'FrequencyTracker':
        """Return the tracker after a detection; `reach` limits the deviation. [Hz]"""
        # First-order low pass
        error = self.error + PULL * (frequency - self.nominal - self.error)
        return FrequencyTracker(self.nominal, min(max(error, -reach), reach))

    def coast_without_detection(self, blocks: int = 1) -> 'FrequencyTracker':
        """Return the tracker after blocks without the beacon."""
        silent = self.silent + blocks
        return replace(self, error=0.0 if silent >= PATIENCE else self.error, silent=silent)


def tracking_range(
    beacon: float, beacons: Sequence[float], flicker: Sequence[float], apart: float
) -> float:
    """
    Return how far a beacon may be tracked without entering the bins of another. [Hz]

    `apart` is half the width of the search range; `flicker` are the frequencies of mains lamps.
    """
    # Two beacons may each move half of the way
    ways = [0.5 * abs(other - beacon) - apart for other in beacons if other != beacon]
    ways += [abs(other - beacon) - apart for other in flicker]
    return max(0.0, min([REACH * beacon, *ways]))


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
        enough = FOUND if detected else LOST
        return (
            BeaconPresence(detected) if against >= enough else BeaconPresence(self.found, against)
        )
