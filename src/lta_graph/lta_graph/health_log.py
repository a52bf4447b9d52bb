"""Decide which changes of health deserve a line: each fault and its end, but no flapping."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
import re
from typing import final, NamedTuple

from lta_config.errors import to_one_line
from lta_graph.health import HealthFact, HealthLevel

FIGURE = re.compile(r'[0-9.]+')  # numbers, which may differ between reports of one fault
WINDOW = 10.0  # wall s in which one status of a task gets two lines, and is then counted
LINES = 2  # the first recurrence gets one, so that a brief fault does not hide a later one
STATUSES = 8  # of one task that get lines in a window: messages may quote what others send


class HealthLine(NamedTuple):
    """A line to log, at the level of the fact that it reports."""

    level: HealthLevel
    text: str


@final
@dataclass(slots=True)
class TaskLog:
    """What was logged of one task, by status: level and message without numbers; '' for OK."""

    since: float  # begin of the window [wall s]
    status: str = ''
    lines: Counter[str] = field(default_factory=Counter)
    left_out: int = 0  # changes without a line in this window

    def takes(self, status: str) -> bool:
        """Count a change to a status, and return whether it gets a line."""
        self.status = status
        is_new = status not in self.lines
        has_line = len(self.lines) < STATUSES if is_new else self.lines[status] < LINES
        if has_line:
            self.lines[status] += 1
        else:
            self.left_out += 1
        return has_line


@final
class HealthLog:
    """
    The lines of some tasks: each change to WARN or ERROR once, and the return to OK.

    A status that comes and goes gets `LINES` lines in a `WINDOW`; its other changes are counted,
    and one line a window says how many there were.
    """

    def __init__(self) -> None:
        self._tasks: dict[str, TaskLog] = {}

    def update(self, facts: Iterable[HealthFact], now: float) -> list[HealthLine]:
        """Return the lines that facts call for at a time [s], in the order of the facts."""
        lines = []
        for fact in facts:
            status = ''
            if fact.level > HealthLevel.OK:
                # The same fault with other numbers is not a new one
                status = f'{fact.level}: {FIGURE.sub("#", fact.message)}'
            task = self._tasks.get(fact.task)
            if task is None:
                if not status:
                    continue  # nothing was ever wrong
                task = self._tasks[fact.task] = TaskLog(now)
            again = '' if status else 'OK again, '
            text = f'{fact.task}: {again}{to_one_line(fact.message)}'
            if now - task.since > WINDOW:
                if task.left_out:
                    times = f'changed {task.left_out} more times in {now - task.since:.0f} s'
                    lines.append(HealthLine(fact.level, f'{text} ({times})'))
                    task.status = status
                else:
                    task.lines.clear()
                    task.lines[task.status] = 1
                task.since, task.left_out = now, 0
            if status != task.status and task.takes(status):
                lines.append(HealthLine(fact.level, text))
        return lines
