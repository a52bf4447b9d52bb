# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Detect a drone that is lighter than air.

Without lifting thrust it rises, and goes on rising; or it does not sink although a rotor pushes it
down. The firmware calls a drone landed whose motors have stopped, and such a drone is not. No
motor of a Crazyflie reverses, so only ballast, a tether or a rotor that blows upwards brings it
down. Such a rotor stops with the others when the drone is disarmed: a motor must never turn on
because a balloon might rise.
"""

from collections import deque
import math
from typing import Final, final

COAST_WINDOW: Final = 4.0  # s without lifting thrust
LEAST_RISE: Final = 0.1  # m in the second half of the window; less is no motion
# A drone that coasts upwards slows down by its drag; one that is lighter than air does not
LEAST_RISE_SHARE: Final = 0.95  # of the rise in the first half
REST_DUTY: Final = 0.02  # duty, times the vertical share of its axis, of a rotor that does nothing
HEIGHT_GAP: Final = 0.5  # s without a height, after which the window begins anew


@final
class BuoyancyMonitor:
    """
    Watch height and thrust of a drone.

    Attributes
    ----------
    rises : bool
        Whether the drone rose without lifting thrust when it was last observed for a whole window.
    is_held_down : bool
        Whether it did not sink, although a rotor pushed it down all the time.

    """

    def __init__(self) -> None:
        self._heights: deque[tuple[float, float]] = deque()
        self._pushed_since = math.inf
        self.rises = self.is_held_down = False

    def observe(self, now: float, height: float, lifting: float, pressing: float = 0.0) -> None:
        """
        Add an observation.

        Parameters
        ----------
        now : float
            Monotonic time. [s]
        height : float
            NaN if unknown. [m]
        lifting, pressing : float
            Largest duty of a rotor that lifts, and of one that pushes down, times the vertical
            component of its axis; NaN if unknown.

        """
        if not lifting <= REST_DUTY:
            # Pushed up, or perhaps: nothing follows from its height
            self._heights.clear()
            self._pushed_since = math.inf
            self.rises = self.is_held_down = False
            return
        if pressing > REST_DUTY:
            self._pushed_since = min(self._pushed_since, now)
        else:
            self._pushed_since, self.is_held_down = math.inf, False
        if math.isnan(height):
            return
        if self._heights and now - self._heights[-1][0] > HEIGHT_GAP:
            self._heights.clear()
        self._heights.append((now, height))
        while now - self._heights[0][0] > COAST_WINDOW:
            self._heights.popleft()
        if now - self._heights[0][0] >= COAST_WINDOW - HEIGHT_GAP:
            self._judge()

    def _judge(self) -> None:
        (began, first), (ended, last) = self._heights[0], self._heights[-1]
        middle = next(h for t, h in self._heights if t >= 0.5 * (began + ended))
        self.rises = last - middle >= max(LEAST_RISE, LEAST_RISE_SHARE * (middle - first))
        # A heavy drone may still coast upwards
        still = max(abs(last - middle), abs(middle - first)) < LEAST_RISE
        self.is_held_down = self._pushed_since <= began and (self.rises or still)
