"""What a node says of itself: facts with a level, gathered here and published by the node."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
import math
from typing import final


class HealthLevel(IntEnum):
    """Levels of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@final
@dataclass(frozen=True, slots=True)
class HealthFact:
    """One line of a node's health: a task, how it stands, and the figures behind it."""

    task: str
    level: HealthLevel
    message: str
    values: Mapping[str, str] = field(default_factory=dict)

    def parse_numbers(self, *names: str) -> tuple[float, ...] | None:
        """Return figures; None where one is missing or no number, as anybody may speak."""
        try:
            found = tuple(float(self.values[name]) for name in names)
        except (KeyError, ValueError):
            return None
        return found if all(map(math.isfinite, found)) else None


@final
class Health:
    """The facts of one node, the newest of each task; tells when a level has changed."""

    def __init__(self) -> None:
        self._facts: dict[str, HealthFact] = {}
        self.changed = False

    def report(self, task: str, level: HealthLevel, message: str, **values: object) -> None:
        """Set the fact of one task."""
        text = {key: str(value) for key, value in values.items()}
        self.set_fact(HealthFact(task, level, message, text))

    def set_fact(self, fact: HealthFact) -> None:
        """Set the fact of its task."""
        before = self._facts.get(fact.task)
        self.changed |= before is None or before.level != fact.level
        self._facts[fact.task] = fact

    def __contains__(self, task: str) -> bool:
        """Tell whether a task has been reported."""
        return task in self._facts

    @property
    def facts(self) -> list[HealthFact]:
        """All facts, in the order in which their tasks were first reported."""
        return list(self._facts.values())
