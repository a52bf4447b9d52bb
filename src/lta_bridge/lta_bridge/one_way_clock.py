# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Map a device's clock to graph time from the arrival times of its stamped messages.

The fastest messages determine the offset: a line is fitted below all differences of arrival and
stamp. Its slope is the drift of the device's crystal. The delay of the fastest message itself is
not observable; if it is known from elsewhere, it is subtracted.
"""

from collections import deque
from typing import Final, final

import numpy as np

WINDOW_NS: Final = 1_000_000_000  # the fastest message of each window is kept
WINDOWS: Final = 60
ENOUGH: Final = 5  # windows needed to estimate the drift
LARGEST_CLOCK_DRIFT: Final = 200e-6  # largest drift of a crystal, with margin [1]
# A message this early means that the device's clock restarted
RESTART_JUMP_NS: Final = 500_000_000
# Beyond any reordering of a network: the device's clock was set back
SET_BACK_NS: Final = 100_000_000


@final
class OneWayClock:
    """
    Map a device's time to graph time.

    Attributes
    ----------
    drift : float
        Relative rate error of the device's clock, positive if it runs fast. [1]
    one_way_ns : int
        Known delay of the fastest message. [ns]
    restarts : int
        Number of restarts of the device's clock.

    """

    def __init__(self) -> None:
        self.one_way_ns = 0
        self.restarts = 0
        self._reset_estimate()

    def _reset_estimate(self) -> None:
        self._lows: deque[tuple[int, int]] = deque(maxlen=WINDOWS)  # device, difference [ns]
        self._offset, self._slope, self._from = 0.0, 0.0, 0

    @property
    def drift(self) -> float:
        """Relative rate error of the device's clock, positive if it runs fast [1]."""
        return -self._slope

    def discard_estimate(self) -> None:
        """Discard the estimate, because the device's clock was set."""
        self.restarts += 1
        self._reset_estimate()

    def stamp_arrival(self, device_ns: int, arrival_ns: int) -> int:
        """Add a message and return its graph time, never later than its arrival [ns]."""
        ahead = self._predict_fastest(device_ns) - arrival_ns
        if self._lows and (ahead > RESTART_JUMP_NS or ahead < -20 * RESTART_JUMP_NS):
            self.discard_estimate()
        self._update_line(device_ns, arrival_ns - device_ns)
        return min(self.to_graph_time(device_ns), arrival_ns)

    def to_graph_time(self, device_ns: int) -> int:
        """Convert a device time to graph time; needs at least one message [ns]."""
        return self._predict_fastest(device_ns) - self.one_way_ns

    def _predict_fastest(self, device_ns: int) -> int:
        return device_ns + round(self._offset + self._slope * (device_ns - self._from))

    def _update_line(self, device_ns: int, difference: int) -> None:
        """Update the fastest message of each window and the line below all of them."""
        if self._lows and device_ns - self._lows[-1][0] < WINDOW_NS:
            self._lows[-1] = (self._lows[-1][0], min(difference, self._lows[-1][1]))
            below = difference - self._slope * (device_ns - self._from)
            self._offset = min(self._offset, below)
            return
        self._lows.append((device_ns, difference))
        # Subtract as integers: nanoseconds since the epoch exceed the precision of a float.
        times = np.array([item - device_ns for item, _ in self._lows], dtype=np.float64)
        lows = np.array([low - difference for _, low in self._lows], dtype=np.float64)
        self._from = device_ns
        slope = 0.0
        if len(lows) >= ENOUGH:
            slope = float(
                np.clip(np.polyfit(times, lows, 1)[0], -LARGEST_CLOCK_DRIFT, LARGEST_CLOCK_DRIFT)
            )
        self._slope = slope
        self._offset = difference + float(np.min(lows - slope * times))
