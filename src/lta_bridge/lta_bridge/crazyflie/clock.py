"""
The Crazyflie's clock in graph time: unwrapped, with offset and drift from when packets arrive.

A packet cannot arrive before it was sent, so the offset is what the fastest packets tell: the line
under all differences of arrival and stamp. Its slope is the drift of the drone's crystal. What
even the fastest packet takes, half of the best round trip, is taken off.
"""

from collections import deque
from typing import Final, final

import numpy as np

WRAP: Final = 1 << 24  # ms; the stamp of a log packet has 24 bits, 4.66 h
WINDOW_NS: Final = 1_000_000_000  # one fastest packet is kept of each
WINDOWS: Final = 60
ENOUGH: Final = 5  # windows from which drift is estimated
FASTEST: Final = 200e-6  # largest drift that a crystal has, with margin [1]
JUMP_NS: Final = 500_000_000  # a packet this early says that the drone's clock began again


@final
class DeviceClock:
    """
    Map log stamps to graph time.

    Attributes
    ----------
    drift : float
        By how much the drone's clock runs fast. [1]
    one_way_ns : int
        What the fastest packet takes; set from the round trip. [ns]
    restarts : int
        How often the drone's clock began again.

    """

    def __init__(self) -> None:
        self.one_way_ns = 0
        self.restarts = 0
        self._forget()

    def _forget(self) -> None:
        self._newest: int | None = None  # unwrapped [ms]
        self._lows: deque[tuple[int, int]] = deque(maxlen=WINDOWS)  # device, difference [ns]
        self._offset, self._slope, self._from = 0.0, 0.0, 0

    @property
    def drift(self) -> float:
        """By how much the drone's clock runs fast. [1]."""
        return -self._slope

    def stamp(self, stamp_ms: int, arrival_ns: int) -> int:
        """
        Return the graph time of a log packet, never later than its arrival.

        Parameters
        ----------
        stamp_ms : int
            24 bits of milliseconds since the boot.
        arrival_ns : int
            When it arrived, graph time. [ns]

        """
        device = 1_000_000 * self._unwrapped(stamp_ms)
        ahead = self._predicted(device) - arrival_ns
        if self._lows and (ahead > JUMP_NS or ahead < -20 * JUMP_NS):
            self.restarts += 1
            self._forget()
            device = 1_000_000 * self._unwrapped(stamp_ms)
        self._learn(device, arrival_ns - device)
        return min(self._predicted(device) - self.one_way_ns, arrival_ns)

    def _unwrapped(self, stamp_ms: int) -> int:
        """Return milliseconds since the first wrap, late packets included."""
        if self._newest is None:
            self._newest = stamp_ms
            return stamp_ms
        ahead = (stamp_ms - self._newest + WRAP // 2) % WRAP - WRAP // 2
        time = self._newest + ahead
        self._newest = max(self._newest, time)
        return time

    def _predicted(self, device: int) -> int:
        return device + round(self._offset + self._slope * (device - self._from))

    def _learn(self, device: int, difference: int) -> None:
        """Keep the fastest packet of each window, and the line under all of them."""
        if self._lows and device - self._lows[-1][0] < WINDOW_NS:
            self._lows[-1] = (self._lows[-1][0], min(difference, self._lows[-1][1]))
            below = difference - self._slope * (device - self._from)
            self._offset = min(self._offset, below)
            return
        self._lows.append((device, difference))
        times, lows = np.array(self._lows, dtype=np.float64).T
        self._from = device
        times -= device
        slope = 0.0
        if len(lows) >= ENOUGH:
            slope = float(np.clip(np.polyfit(times, lows - lows[-1], 1)[0], -FASTEST, FASTEST))
        self._slope = slope
        self._offset = float(np.min(lows - slope * times))
