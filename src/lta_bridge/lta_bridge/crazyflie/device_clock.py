"""The Crazyflie's clock in graph time: 24-bit milliseconds, unwrapped, with offset and drift."""

from typing import Final, final

from lta_bridge.one_way_clock import BACK_NS, OneWayClock

WRAP: Final = 1 << 24  # ms; the stamp of a log packet has 24 bits, 4.66 h
BACK_MS: Final = BACK_NS // 1_000_000


@final
class DeviceClock:
    """
    Map log stamps to graph time.

    Attributes
    ----------
    line : OneWayClock
        Offset and drift.

    """

    def __init__(self) -> None:
        self.line = OneWayClock()
        self._newest: int | None = None  # unwrapped [ms]

    @property
    def drift(self) -> float:
        """By how much the drone's clock runs fast. [1]."""
        return self.line.drift

    def stamp_packet(self, stamp_ms: int, arrival_ns: int) -> int:
        """
        Return the graph time of a log packet, never later than its arrival.

        Parameters
        ----------
        stamp_ms : int
            24 bits of milliseconds since the boot.
        arrival_ns : int
            When it arrived, graph time. [ns]

        """
        return self.line.stamp_arrival(1_000_000 * self._unwrap_stamp(stamp_ms), arrival_ns)

    def _unwrap_stamp(self, stamp_ms: int) -> int:
        """Return milliseconds since the first wrap, late packets included."""
        if self._newest is None:
            self._newest = stamp_ms
            return stamp_ms
        ahead = (stamp_ms - self._newest + WRAP // 2) % WRAP - WRAP // 2
        if ahead < -BACK_MS:  # it started anew, and has not been up for long
            self.line.restart()
            self._newest = stamp_ms
            return stamp_ms
        time = self._newest + ahead
        self._newest = max(self._newest, time)
        return time
