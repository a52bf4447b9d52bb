# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The health of nodes: one status per task for /diagnostics, the lines it calls for, and its cause.

Each fault and its end deserve a line, but no flapping. When one node dies in lockstep, every node
downstream waits for the one before it: the culprit is the node that others wait for and that does
not itself report waiting.
"""

from collections import Counter, deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
import math
import re
from typing import Final, final, NamedTuple

from lta_config.errors import to_one_line

ENDS_RUN: Final = 'ends_run'  # value in `state`: whether the node's fault ends the others, too
MAX_NEWS: Final = 100  # changes of status that are kept until the next report
NUMBER_PATTERN: Final = re.compile(r'[0-9.]+')  # which may differ between reports of one fault
CLOCK_TOLERANCE: Final = 0.3  # s; a stamp further ahead of ours means a changed clock


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

    @property
    def status(self) -> str:
        """Level and message without numbers, as the same fault has others; '' if all is well."""
        if self.level == HealthLevel.OK:
            return ''
        return f'{self.level}: {NUMBER_PATTERN.sub("#", self.message)}'

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
        self._news: deque[HealthFact] = deque(maxlen=MAX_NEWS)
        self.changed = False

    def report(self, task: str, level: HealthLevel, message: str, **values: object) -> None:
        """Set the status of one task."""
        before = self._facts.get(task)
        text = dict(zip(values, map(str, values.values()), strict=True))
        fact = self._facts[task] = HealthFact(task, level, message, text)
        # Another fault at the same level waits for the next periodic report, and is not lost
        is_new_level = before is None or before.level != level
        self.changed |= is_new_level
        if before is None or before.status != fact.status:
            self._news.append(fact)

    def set_fact(self, fact: HealthFact) -> None:
        """Set the status of the fact's task."""
        self.report(fact.task, fact.level, fact.message, **fact.values)

    def __contains__(self, task: str) -> bool:
        """Return whether a task has been reported."""
        return task in self._facts

    def take_news(self) -> list[HealthFact]:
        """Return, once, the facts with a new status, oldest first, and then all present ones."""
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
    return passed if passed >= -CLOCK_TOLERANCE else math.inf


LOG_WINDOW = 10.0  # wall s in which one status of a task gets two lines, and is then counted
# The first recurrence gets one, so that a brief fault does not hide a later one
LINES_PER_STATUS = 2
MAX_STATUSES = 8  # of one task that get lines in a window: messages may quote what others send


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
        has_line = (
            len(self.lines) < MAX_STATUSES if is_new else self.lines[status] < LINES_PER_STATUS
        )
        if has_line:
            self.lines[status] += 1
        else:
            self.left_out += 1
        return has_line


@final
class HealthLog:
    """
    The lines of some tasks: each change to WARN or ERROR once, and the return to OK.

    A status that comes and goes gets `LINES_PER_STATUS` lines in a `LOG_WINDOW`; its other changes
    are counted, and one line a window says how many there were.
    """

    def __init__(self) -> None:
        self._tasks: dict[str, TaskLog] = {}

    def update(self, facts: Iterable[HealthFact], now: float) -> list[HealthLine]:
        """Return the lines that facts call for at a time [s], in the order of the facts."""
        lines = []
        for fact in facts:
            status = fact.status
            task = self._tasks.get(fact.task)
            if task is None:
                if not status:
                    continue  # nothing was ever wrong
                task = self._tasks[fact.task] = TaskLog(now)
            again = '' if status else 'OK again, '
            text = f'{fact.task}: {again}{to_one_line(fact.message)}'
            if now - task.since > LOG_WINDOW:
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


INPUT_TASK = 'inputs'
OTHER_ROLES = {'simulator': 'vehicle', 'player': 'vehicle'}  # nodes whose role has another name


def find_stalling_roles(facts: Iterable[HealthFact]) -> list[str]:
    """
    Return the roles that keep others waiting, in alphabetical order.

    `facts`: the newest facts of all nodes, with tasks named 'NODE: TASK', or 'ROBOT/NODE: TASK' as
    on /diagnostics.
    """
    # `waiting` are roles that report missing inputs, `suspects` the roles they wait for
    waiting, suspects = set(), set()
    for fact in facts:
        node, _, task = fact.task.partition(': ')
        if task == INPUT_TASK and fact.level == HealthLevel.ERROR:
            robot, slash, _ = node.rpartition('/')
            waiting.add(find_role(node))
            roles = set(fact.values.get('suspects', '').split(',')) - {''}
            # An absolute suspect (`/lta2/vehicle`) names its robot; a relative one belongs to the
            # same robot
            suspects |= {item[1:] if item[0] == '/' else robot + slash + item for item in roles}
    # A suspect that waits as well is only a link of the chain; a role without a robot serves all
    return sorted(role for role in suspects - waiting if role.rpartition('/')[2] not in waiting)


def find_role(node: str) -> str:
    """Return the role of a node, with the same robot prefix as the node's name."""
    robot, slash, name = node.rpartition('/')
    return robot + slash + OTHER_ROLES.get(name, name)


LONGEST_REJECTION_REASON: Final = (
    200  # characters of a reason, whose length the faulty sender controls
)


@final
class RejectionCount:
    """
    A count of invalid inputs.

    Attribute `count`: number of invalid inputs. Attribute `why`: the last reason; empty if there
    was none.
    """

    def __init__(self) -> None:
        self.count = 0
        self.why = ''

    def add(self, why: str) -> None:
        """Count one invalid input."""
        self.count += 1
        self.why = (
            why
            if len(why) <= LONGEST_REJECTION_REASON
            else f'{why[:LONGEST_REJECTION_REASON]} ...'
        )

    def build_fact(self, task: str, fine: str = 'all valid') -> HealthFact:
        """Return the count as the fact of a task, with the message `fine` if it is 0."""
        level = HealthLevel.WARN if self.count else HealthLevel.OK
        words = f'{self.count} invalid inputs; the last one: {self.why}' if self.count else fine
        return HealthFact(task, level, words, {'count': str(self.count)})
