"""
Measure the latency of the link by pings.

The one-way delay is taken as half of the shortest round trip; pings cannot show an asymmetry. The
shortest one is taken over the same time as the clock's fit (`one_way_clock.WINDOWS`), so that a
link that becomes slower does not shift the stamps.
"""

from collections import deque
import math
import struct
from typing import Final, final

from lta_bridge.one_way_clock import WINDOWS
import numpy as np

PINGS: Final = 10  # Hz, rate of cflib's pings
NEWEST: Final = 10 * PINGS  # pings for the present latency: the last 10 s
# First byte of cflib's ping; its layout with send time [s]
PING_MARK, SENT = 0, struct.Struct('<Bd')
# s; a longer round trip means that the computer's clock was set meanwhile
LONGEST_ROUND_TRIP: Final = 10.0


def parse_ping_time(echo: bytes | bytearray) -> float | None:
    """Return the send time of an echoed ping; None if the packet is not a ping. [s]"""
    if len(echo) != SENT.size:
        return None
    mark, sent = SENT.unpack(echo)
    return float(sent) if mark == PING_MARK else None


@final
class RoundTrips:
    """The round trips of the last minute."""

    def __init__(self) -> None:
        self._recent: deque[float] = deque(maxlen=WINDOWS * PINGS)

    def add(self, seconds: float) -> None:
        """Add one round trip; ignore implausible values. [s]"""
        if 0.0 < seconds < LONGEST_ROUND_TRIP:
            self._recent.append(seconds)

    @property
    def latency(self) -> float:
        """95th percentile of the newest round trips; NaN before the first. [s]"""
        newest = list(self._recent)[-NEWEST:]
        return float(np.percentile(newest, 95)) if newest else math.nan

    @property
    def one_way_ns(self) -> int:
        """Half of the shortest round trip; 0 before the first. [ns]"""
        return round(0.5e9 * min(self._recent, default=0.0))
