"""Track the frequency of one beacon over blocks, for lamps with clock error or drift."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

PULL = 0.25  # gain of the low-pass filter on the measured frequency
REACH = 0.05  # largest clock error that is tracked, relative to the frequency
PATIENCE = 20  # blocks without the beacon after which the search returns to the nominal


@final
@dataclass(frozen=True, slots=True)
class FrequencyTracker:
    """
    Where a beacon is expected in the next block.

    Parameters
    ----------
    nominal : float
        Where it should flicker. [Hz]
    error : float
        How far off it has been found. [Hz]
    silent : int
        Blocks since it was heard.

    """

    nominal: float
    error: float = 0.0
    silent: int = 0

    def update(self, frequency: float, reach: float) -> 'FrequencyTracker':
        """
        Return the tracker after a block in which the beacon was heard.

        Parameters
        ----------
        frequency : float
            Where. [Hz]
        reach : float
            How far from its nominal frequency it may be followed. [Hz]

        """
        error = self.error + PULL * (frequency - self.nominal - self.error)
        return FrequencyTracker(self.nominal, min(max(error, -reach), reach))

    def coast(self, blocks: int = 1) -> 'FrequencyTracker':
        """Return the tracker after blocks without the beacon."""
        silent = self.silent + blocks
        return replace(self, error=0.0 if silent >= PATIENCE else self.error, silent=silent)


def tracking_range(
    beacon: float, beacons: Sequence[float], flicker: Sequence[float], apart: float
) -> float:
    """
    Return how far a beacon is followed: never to where it is sought in the bins of another. [Hz]

    Parameters
    ----------
    beacon : float
        Where it should flicker. [Hz]
    beacons, flicker : sequence of float
        Where all beacons should, and where lamps on the mains do. [Hz]
    apart : float
        Half the width of the range in which a beacon is sought. [Hz]

    """
    ways = [0.5 * abs(other - beacon) - apart for other in beacons if other != beacon]
    ways += [abs(other - beacon) - apart for other in flicker]
    return max(0.0, min([REACH * beacon, *ways]))
