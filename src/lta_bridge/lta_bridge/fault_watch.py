"""When the diagnostics of a graph tell of a fault that is new."""

from collections.abc import Iterable
from typing import final

REST = 10.0  # wall seconds in which further faults wait, and then count as one


@final
class FaultWatch:
    """
    Tell once of each fault: a status that has become an error.

    A fault that comes while the watch rests is told when the rest is over, so that a graph that
    fails all over, or flickers, is told of at most once in `REST`.
    """

    def __init__(self) -> None:
        self._failing: set[str] = set()
        self._news: dict[str, None] = {}
        self._rests_until = float('-inf')

    def hear(self, statuses: Iterable[tuple[str, bool]]) -> None:
        """
        Take note of a diagnostics message.

        Parameters
        ----------
        statuses : iterable of (str, bool)
            Whose and which status, and whether it is an error.

        """
        for name, failing in statuses:
            if not failing:
                self._failing.discard(name)
            elif name not in self._failing:
                self._failing.add(name)
                self._news[name] = None

    def due(self, now: float) -> list[str]:
        """Return the faults to tell now, and rest if there are any. [wall s]"""
        if not self._news or now < self._rests_until:
            return []
        told = list(self._news)
        self._news.clear()
        self._rests_until = now + REST
        return told
