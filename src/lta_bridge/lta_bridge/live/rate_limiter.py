"""How often something is shown to people: a limit by the wall clock, steady under jitter."""

from typing import final


@final
class RateLimiter:
    """
    A limit of events a wall second.

    What comes as often as the limit, some of it early and some late, passes whole: an event may
    be early by half an interval, and the next is counted from when it was due.

    Parameters
    ----------
    rate : float
        Most events a second in the long run. [Hz]

    """

    def __init__(self, rate: float) -> None:
        self._interval = 1.0 / rate
        self._due = -float('inf')

    def try_acquire(self, now: float) -> bool:
        """Tell whether an event at a wall time passes, and count it if so. [s]"""
        if now < self._due - 0.5 * self._interval:
            return False
        self._due = max(self._due, now - 0.5 * self._interval) + self._interval
        return True
