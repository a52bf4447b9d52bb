"""When the diagnostics of a graph tell of a fault that is new."""

from collections.abc import Iterable
from typing import final, NamedTuple

REST = 10.0  # wall seconds in which further faults wait, and then count as one
INPUTS = ': inputs'  # the task in which a node says that it waits for others


class TaskStatus(NamedTuple):
    """
    One status of a diagnostics message.

    Attributes
    ----------
    robot, task : str
        Whose it is, and which: 'lta1', 'controller: inputs'.
    failing : bool
        Whether it is an error.
    over : bool
        Whether it says that the robot's flight or replay has come to its end.

    """

    robot: str
    task: str
    failing: bool
    over: bool = False


@final
class FaultWatch:
    """
    Tell once of each fault: a status that has become an error.

    A fault that comes while the watch rests is told when the rest is over, so that a graph that
    fails all over, or flickers, is told of at most once in `REST`. That nodes wait for a vehicle
    whose flight is over is no fault.

    Attributes
    ----------
    over : set of str
        The robots that have said that their flight or replay is over.

    """

    def __init__(self) -> None:
        self.over: set[str] = set()
        self._failing: set[str] = set()
        self._news: dict[str, None] = {}
        self._rests_until = float('-inf')

    def add_statuses(self, statuses: Iterable[TaskStatus]) -> None:
        """Take note of a diagnostics message."""
        for status in statuses:
            if status.over:
                self.over.add(status.robot)
            name = f'{status.robot}/{status.task}'.lstrip('/')
            left_alone = status.robot in self.over and status.task.endswith(INPUTS)
            if not status.failing or left_alone:
                self._failing.discard(name)
            elif name not in self._failing:
                self._failing.add(name)
                self._news[name] = None

    def take_new_faults(self, now: float) -> list[str]:
        """Return the faults to tell now, and rest if there are any. [wall s]"""
        if not self._news or now < self._rests_until:
            return []
        told = list(self._news)
        self._news.clear()
        self._rests_until = now + REST
        return told
