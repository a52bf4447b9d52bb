"""Limit the rate of events by the wall clock, tolerant of jitter."""

from typing import final


@final
class RateLimiter:
    """
    Limit events to a mean rate. [Hz]

    Events at exactly this rate all pass despite jitter: one may be early by half an interval, and
    the next interval counts from when it was due.
    """

    def __init__(self, rate: float) -> None:
        self._interval = 1.0 / rate
        self._due = -float('inf')

    def try_acquire(self, now: float) -> bool:
        """Return whether an event at a wall time passes; count it if so. [s]"""
        if now < self._due - 0.5 * self._interval:
            return False
        self._due = max(self._due, now - 0.5 * self._interval) + self._interval
        return True
