"""Decide whether a beacon is present, with hysteresis over blocks."""

from typing import NamedTuple

FOUND = 2  # blocks in a row with the beacon after which it is found
LOST = 5  # blocks in a row without it after which it is lost


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
