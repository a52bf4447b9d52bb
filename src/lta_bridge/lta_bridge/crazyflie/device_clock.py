"""Convert the Crazyflie's 24-bit millisecond stamps to graph time."""

from typing import Final, final

from lta_bridge.one_way_clock import BACK_NS, OneWayClock

STAMP_WRAP: Final = 1 << 24  # ms; the stamp of a log packet has 24 bits, 4.66 h
BACK_MS: Final = BACK_NS // 1_000_000


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
        """Relative rate error of the drone's clock, positive if it runs fast. [1]"""
        return self.line.drift

    def compute_packet_time(self, stamp_ms: int, arrival_ns: int) -> int:
        """
        Return the graph time of a log packet, never later than its arrival.

        `stamp_ms`: milliseconds since boot, modulo 2^24. `arrival_ns`: graph time of arrival [ns].
        """
        return self.line.stamp_arrival(1_000_000 * self._unwrap_stamp(stamp_ms), arrival_ns)

    def _unwrap_stamp(self, stamp_ms: int) -> int:
        """Return a stamp that does not wrap; late packets are allowed. [ms]"""
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
