"""Collect the health of a node, one status per task, for /diagnostics; the age of its data."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
import math
from typing import Final, final

ENDS_RUN: Final = 'ends_run'  # value in `state`: whether the node's fault ends the others, too
NEWS: Final = 100  # changes of level that are kept until the next report
AHEAD: Final = 0.3  # s; a stamp further ahead of our clock means that a clock was changed


class HealthLevel(IntEnum):
    """Levels of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@final
@dataclass(frozen=True, slots=True)
class HealthFact:
    """The status of one task, with a message and values."""

    task: str
    level: HealthLevel
    message: str
    values: Mapping[str, str] = field(default_factory=dict)

    def parse_numbers(self, *names: str) -> tuple[float, ...] | None:
        """Return values as finite numbers; None if one is missing or invalid."""
        # Any node may publish on /diagnostics, so do not trust the content.
        try:
            numbers = tuple(float(self.values[name]) for name in names)
        except (KeyError, ValueError):
            return None
        return numbers if all(map(math.isfinite, numbers)) else None


@final
class Health:
    """The latest status of each task of a node; `changed` is set when a level changes."""

    def __init__(self) -> None:
        self._facts: dict[str, HealthFact] = {}
        self._news: deque[HealthFact] = deque(maxlen=NEWS)
        self.changed = False

    def report(self, task: str, level: HealthLevel, message: str, **values: object) -> None:
        """Set the status of one task."""
        before = self._facts.get(task)
        # A changed message alone waits for the next periodic report
        is_news = before is None or before.level != level
        self.changed |= is_news
        text = dict(zip(values, map(str, values.values()), strict=True))
        fact = self._facts[task] = HealthFact(task, level, message, text)
        if is_news:
            self._news.append(fact)

    def set_fact(self, fact: HealthFact) -> None:
        """Set the status of the fact's task."""
        self.report(fact.task, fact.level, fact.message, **fact.values)

    def __contains__(self, task: str) -> bool:
        """Return whether a task has been reported."""
        return task in self._facts

    def take_news(self) -> list[HealthFact]:
        """Return, once, the facts with new levels, oldest first, and then all present ones."""
        news = [*self._news, *self.facts]
        self._news.clear()
        return news

    @property
    def facts(self) -> list[HealthFact]:
        """All facts, in the order in which their tasks were first reported."""
        return list(self._facts.values())


def stamp_age(stamp_ns: int | None, now_ns: int) -> float:
    """
    Return the age [s] of data stamped `stamp_ns` at graph time `now_ns` [ns].

    The age is infinite if there is no stamp, or if it is far in the future: otherwise such data
    would stay the newest long after its sender died.
    """
    if stamp_ns is None:
        return math.inf
    # Small negative ages come from the delay between clocks
    passed = 1e-9 * (now_ns - stamp_ns)
    return passed if passed >= -AHEAD else math.inf
