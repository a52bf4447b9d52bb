"""Detect new faults in the diagnostics of a graph."""

from collections.abc import Iterable
from typing import final, NamedTuple

REST = 10.0  # wall seconds between two reports; faults in between are reported together
INPUTS = ': inputs'  # suffix of the task in which a node reports missing inputs


class DiagnosticsEntry(NamedTuple):
    """One status of a diagnostics message."""

    # For example 'lta1' and 'controller: inputs'
    robot: str
    task: str
    failing: bool  # whether the status is an error
    over: bool = False  # whether the status reports the end of the robot's flight or replay


@final
class FaultWatch:
    """
    Report each fault once, when its status becomes an error.

    Reports are at least `REST` apart, so that many or flickering faults do not flood the user.
    Missing inputs from a robot whose flight is over are not a fault.

    `over` holds the robots whose flight or replay is over.
    """

    def __init__(self) -> None:
        self.over: set[str] = set()
        self._failing: set[str] = set()
        self._news: dict[str, None] = {}
        self._rests_until = float('-inf')

    def add_statuses(self, statuses: Iterable[DiagnosticsEntry]) -> None:
        """Add the statuses of a diagnostics message."""
        for status in statuses:
            if status.over:
                self.over.add(status.robot)
            name = f'{status.robot}/{status.task}'.lstrip('/')
            ignored = status.robot in self.over and status.task.endswith(INPUTS)
            if not status.failing or ignored:
                self._failing.discard(name)
            elif name not in self._failing:
                self._failing.add(name)
                self._news[name] = None

    def take_new_faults(self, now: float) -> list[str]:
        """Return the new faults, or nothing within `REST` of the last report. [wall s]"""
        if not self._news or now < self._rests_until:
            return []
        faults = list(self._news)
        self._news.clear()
        self._rests_until = now + REST
        return faults
