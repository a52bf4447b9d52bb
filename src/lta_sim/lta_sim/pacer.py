"""Keep simulated time at the pace of the wall clock."""

import time
from typing import final

LARGEST_CATCH_UP = 50  # control periods of delay that are caught up
# Control periods that are caught up without a pause: fewer than the queue of a sensor topic holds,
# as readers in the same process are called only afterwards
BURST_STEPS = 4
LOST_TIME_SHARE = 0.05  # share of the wall clock that may be lost before a report


@final
class Pacer:
    """
    Tell how many control steps are due: catch up after a short delay, and skip a long one.

    `period`: the control period [s].

    Attributes
    ----------
    began : float
        Wall time of the first step; 0 before. [s]
    lost : float
        Wall time of skipped delays. [s]

    """

    def __init__(self, period: float) -> None:
        self.lost = 0.0
        self.period = period
        self.began = self._anchor = 0.0

    def begin(self) -> None:
        """Begin to count now."""
        self.began = self._anchor = time.monotonic()

    @property
    def is_slow(self) -> bool:
        """Whether a noticeable part of the wall time is lost."""
        return self.lost > LOST_TIME_SHARE * (time.monotonic() - self.began)

    def count_due(self, steps: int) -> int:
        """Return how many steps to fly now, after so many."""
        due = round((time.monotonic() - self._anchor) / self.period) - steps
        if due > LARGEST_CATCH_UP:
            self._anchor += (due - 1) * self.period
            self.lost += (due - 1) * self.period
            return 1
        return min(due, BURST_STEPS)
