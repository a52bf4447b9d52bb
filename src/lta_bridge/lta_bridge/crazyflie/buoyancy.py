"""
Detect a drone that is lighter than air: without lifting thrust it rises, and goes on rising.

The firmware calls a drone landed whose motors have stopped, and such a drone is not. No motor of a
Crazyflie reverses, so only ballast, a tether or a rotor that blows upwards brings it down.
"""

from collections import deque
import math
from typing import Final, final

WINDOW: Final = 4.0  # s without lifting thrust
RISE: Final = 0.1  # m in the second half of the window
# A drone that coasts upwards slows down by its drag; one that is lighter than air does not
KEPT: Final = 0.95  # of the rise in the first half
IDLE: Final = 0.02  # duty below which a rotor does not lift
GAP: Final = 0.5  # s without a height, after which the window begins anew


@final
class BuoyancyMonitor:
    """
    Watch height and thrust of a drone.

    Attributes
    ----------
    rises : bool
        Whether the drone rose without lifting thrust when it was last observed for a whole window.

    """

    def __init__(self) -> None:
        self._heights: deque[tuple[float, float]] = deque()
        self.rises = False

    def observe(self, now: float, height: float, lifting: float) -> None:
        """
        Add an observation.

        Parameters
        ----------
        now : float
            Monotonic time. [s]
        height : float
            NaN if unknown. [m]
        lifting : float
            Largest duty of a rotor that lifts; NaN if unknown.

        """
        if not lifting <= IDLE:
            # Pushed up, or perhaps: nothing follows from its height
            self._heights.clear()
            self.rises = False
            return
        if math.isnan(height):
            return
        if self._heights and now - self._heights[-1][0] > GAP:
            self._heights.clear()
        self._heights.append((now, height))
        while now - self._heights[0][0] > WINDOW:
            self._heights.popleft()
        if now - self._heights[0][0] >= WINDOW - GAP:
            self.rises = self._keeps_rising()

    def _keeps_rising(self) -> bool:
        (began, first), (ended, last) = self._heights[0], self._heights[-1]
        middle = next(h for t, h in self._heights if t >= 0.5 * (began + ended))
        return last - middle >= max(RISE, KEPT * (middle - first))
