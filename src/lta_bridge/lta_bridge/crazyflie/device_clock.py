# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Time of a Crazyflie: its 24-bit millisecond stamps in graph time, and the latency of its link.

The one-way delay is taken as half of the shortest round trip of pings; they cannot show an
asymmetry. The shortest one is taken over the same time as the clock's fit
(`one_way_clock.WINDOWS`), so that a link that becomes slower does not shift the stamps.
"""

from collections import deque
import math
import struct
from typing import Final, final

from lta_bridge.one_way_clock import OneWayClock, SET_BACK_NS, WINDOWS
import numpy as np

STAMP_WRAP: Final = 1 << 24  # ms; the stamp of a log packet has 24 bits, 4.66 h
BACK_MS: Final = SET_BACK_NS // 1_000_000


@final
class DeviceClock:
    """
    Unwrap log stamps and map them to graph time.

    `line` estimates the clock's offset and drift.
    """

    def __init__(self) -> None:
        self.line = OneWayClock()
        self._newest: int | None = None  # unwrapped [ms]

    @property
    def drift(self) -> float:
        """Relative rate error of the drone's clock, positive if it runs fast [1]."""
        return self.line.drift

    def compute_packet_time(self, stamp_ms: int, arrival_ns: int) -> int:
        """
        Return the graph time of a log packet, never later than its arrival.

        `stamp_ms`: milliseconds since boot, modulo 2^24. `arrival_ns`: graph time of arrival [ns].
        """
        return self.line.stamp_arrival(1_000_000 * self._unwrap_stamp(stamp_ms), arrival_ns)

    def _unwrap_stamp(self, stamp_ms: int) -> int:
        """Return a stamp that does not wrap; late packets are allowed [ms]."""
        if self._newest is None:
            self._newest = stamp_ms
            return stamp_ms
        # Shortest signed distance on the circle of 2^24 ms.
        ahead = (stamp_ms - self._newest + STAMP_WRAP // 2) % STAMP_WRAP - STAMP_WRAP // 2
        if ahead < -BACK_MS:  # too far back for a late packet: the drone has restarted
            self.line.discard_estimate()
            self._newest = stamp_ms
            return stamp_ms
        time = self._newest + ahead
        self._newest = max(self._newest, time)
        return time


PINGS: Final = 10  # Hz, rate of cflib's pings
NEWEST: Final = 10 * PINGS  # pings for the present latency: the last 10 s
# First byte of cflib's ping; its layout with send time [s]
PING_MARK, SENT = 0, struct.Struct('<Bd')
# s; a longer round trip means that the computer's clock was set meanwhile
LONGEST_ROUND_TRIP: Final = 10.0


def parse_ping_time(echo: bytes | bytearray) -> float | None:
    """Return the send time of an echoed ping; None if the packet is not a ping [s]."""
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
        """Add one round trip; ignore implausible values [s]."""
        if 0.0 < seconds < LONGEST_ROUND_TRIP:
            self._recent.append(seconds)

    @property
    def latency(self) -> float:
        """95th percentile of the newest round trips; NaN before the first [s]."""
        newest = list(self._recent)[-NEWEST:]
        return float(np.percentile(newest, 95)) if newest else math.nan

    @property
    def one_way_ns(self) -> int:
        """Half of the shortest round trip; 0 before the first [ns]."""
        return round(0.5e9 * min(self._recent, default=0.0))
