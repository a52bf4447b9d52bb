"""
A device's clock in graph time, from nothing but when its stamped messages arrive.

A message cannot arrive before it was sent, so the offset is what the fastest messages tell: the
line under all differences of arrival and stamp. Its slope is the drift of the device's crystal.
What even the fastest message takes cannot be seen; where it is known it is taken off.
"""

from collections import deque
from typing import Final, final

import numpy as np

WINDOW_NS: Final = 1_000_000_000  # one fastest message is kept of each
WINDOWS: Final = 60
ENOUGH: Final = 5  # windows from which drift is estimated
FASTEST: Final = 200e-6  # largest drift that a crystal has, with margin [1]
JUMP_NS: Final = 500_000_000  # a message this early says that the device's clock began again
BACK_NS: Final = 100_000_000  # no network reorders so far: the device's clock was set back


@final
class OneWayClock:
    """
    Map a device's time to graph time.

    Attributes
    ----------
    drift : float
        By how much the device's clock runs fast. [1]
    one_way_ns : int
        What the fastest message takes. [ns]
    restarts : int
        How often the device's clock began again.

    """

    def __init__(self) -> None:
        self.one_way_ns = 0
        self.restarts = 0
        self._reset()

    def _reset(self) -> None:
        self._lows: deque[tuple[int, int]] = deque(maxlen=WINDOWS)  # device, difference [ns]
        self._offset, self._slope, self._from = 0.0, 0.0, 0

    @property
    def drift(self) -> float:
        """By how much the device's clock runs fast. [1]."""
        return -self._slope

    def restart(self) -> None:
        """Begin again: the device's clock was set."""
        self.restarts += 1
        self._reset()

    def stamp_arrival(self, device_ns: int, arrival_ns: int) -> int:
        """Return the graph time of a message that arrives now, never later than that. [ns]"""
        ahead = self._predict_fastest(device_ns) - arrival_ns
        if self._lows and (ahead > JUMP_NS or ahead < -20 * JUMP_NS):
            self.restart()
        self._update_line(device_ns, arrival_ns - device_ns)
        return min(self.to_graph_time(device_ns), arrival_ns)

    def to_graph_time(self, device_ns: int) -> int:
        """Return the graph time of a time of the device, once a message has come. [ns]"""
        return self._predict_fastest(device_ns) - self.one_way_ns

    def _predict_fastest(self, device_ns: int) -> int:
        return device_ns + round(self._offset + self._slope * (device_ns - self._from))

    def _update_line(self, device_ns: int, difference: int) -> None:
        """Keep the fastest message of each window, and the line under all of them."""
        if self._lows and device_ns - self._lows[-1][0] < WINDOW_NS:
            self._lows[-1] = (self._lows[-1][0], min(difference, self._lows[-1][1]))
            below = difference - self._slope * (device_ns - self._from)
            self._offset = min(self._offset, below)
            return
        self._lows.append((device_ns, difference))
        # Integers first: times of day in nanoseconds have more digits than a float.
        times = np.array([item - device_ns for item, _ in self._lows], dtype=np.float64)
        lows = np.array([low - difference for _, low in self._lows], dtype=np.float64)
        self._from = device_ns
        slope = 0.0
        if len(lows) >= ENOUGH:
            slope = float(np.clip(np.polyfit(times, lows, 1)[0], -FASTEST, FASTEST))
        self._slope = slope
        self._offset = difference + float(np.min(lows - slope * times))
