"""
How long the way to the drone and back takes, ping by ping.

A message takes half of the quickest, if both ways take equally long: no ping can tell how the two
differ. The quickest is sought among as many as the clock's line is drawn under, so that a link
that becomes slower shifts no stamp.
"""

from collections import deque
import math
import struct
from typing import Final, final

from lta_bridge.one_way_clock import WINDOWS
import numpy as np

PINGS: Final = 10  # a second, of cflib
NEWEST: Final = 10 * PINGS  # those that tell how the link is now
MARK, SENT = 0, struct.Struct('<Bd')  # mark of cflib's ping, and how it tells when it was sent [s]
LONGEST: Final = 10.0  # s; what takes longer was no trip: the computer's clock was set meanwhile


def parse_ping_time(echo: bytes | bytearray) -> float | None:
    """Return when cflib sent the ping that comes back; None where it is none. [s]"""
    if len(echo) != SENT.size:
        return None
    mark, sent = SENT.unpack(echo)
    return float(sent) if mark == MARK else None


@final
class RoundTrips:
    """The round trips of the last minute."""

    def __init__(self) -> None:
        self._kept: deque[float] = deque(maxlen=WINDOWS * PINGS)

    def add(self, seconds: float) -> None:
        """Take one; what cannot be one is left out. [s]"""
        if 0.0 < seconds < LONGEST:
            self._kept.append(seconds)

    @property
    def latency(self) -> float:
        """What 95 % of the newest take at most; NaN before the first. [s]"""
        newest = list(self._kept)[-NEWEST:]
        return float(np.percentile(newest, 95)) if newest else math.nan

    @property
    def one_way_ns(self) -> int:
        """Half of the quickest; 0 before the first. [ns]"""
        return round(0.5e9 * min(self._kept, default=0.0))
