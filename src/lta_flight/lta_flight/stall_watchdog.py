# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Report problems of a running graph: nodes that stall it, and faults that nodes report."""

from collections.abc import Callable, Collection, Iterable, Mapping
import time
from typing import final

from lta_graph.health import (
    ENDS_RUN,
    find_role,
    find_stalling_roles,
    HealthFact,
    HealthLog,
    INPUT_TASK,
)

FLIGHT = 'simulator: flight'  # task with the state of a simulated flight
PLAYBACK = 'player: playback'  # task with the state of a replay
GOING = {FLIGHT: 'flying', PLAYBACK: 'playing'}  # their outcomes until they end
SETTLE = 0.5  # wall seconds; nodes check their inputs at different times
WAIT_FOR_DISCOVERY = 4.0  # wall seconds to wait instead while some nodes are not discovered yet
OTHER_TASKS = (INPUT_TASK, 'processes')  # tasks whose errors are reported elsewhere
STARTING_TIME = (
    8.0  # wall seconds that nodes take to load on a busy machine; report if it takes longer
)


@final
class StallDetector:
    """
    Identify the nodes that stall a graph.

    A node that hangs falls silent, and is named at once. A node that reports but does not answer
    is identified by what the others wait for, which takes a moment to settle.

    Attribute `standing`: duration of the current stall [wall s].
    """

    def __init__(self) -> None:
        self._suspects: list[str] = []
        # Both clocks start now
        self._changed = self._well = time.monotonic()
        self.standing = 0.0

    def identify_stalling_nodes(
        self, suspects: list[str], silent: list[str], all_reporting: bool
    ) -> list[str]:
        """
        Return the nodes to name.

        `suspects`: nodes for which others report to wait. `silent`: running nodes that no longer
        report. `all_reporting`: whether every running node has reported.
        """
        now = time.monotonic()
        if suspects != self._suspects:
            self._suspects, self._changed = suspects, now
        if not suspects and not silent:
            self._well = now
        self.standing = now - self._well
        settled = now - self._changed > (SETTLE if all_reporting else WAIT_FOR_DISCOVERY)
        # Silence is certain, suspects may still change
        return silent or (suspects if settled else [])


@final
class StallMonitor:
    """
    Name the nodes that stall a graph, whenever they change, and report faults of nodes.

    `say`: gets each sentence. `tell`: also gets the sentences on stalls, which no node of the
    graph can report.
    """

    def __init__(
        self, say: Callable[[str], None], tell: Callable[[str], None] = lambda _: None
    ) -> None:
        self._say = say
        self._tell = tell
        self._log = HealthLog()
        self._blame = StallDetector()
        self._named: list[str] = []
        self._begun = time.monotonic()
        self._excused = False

    @property
    def stall_duration(self) -> float:
        """Duration of the current stall [wall s]."""
        return self._blame.standing

    def report_stalled_nodes(
        self, facts: Mapping[str, HealthFact], silent: list[str], unheard: Collection[str] = ()
    ) -> None:
        """
        Check the reports of the nodes, and name the stalled ones if they have changed.

        `facts`: the newest facts, from `DiagnosticsListener`. `silent`: running nodes that no
        longer report, or have not for too long. `unheard`: running nodes that have not reported
        yet: they load, and do not count as stalled.
        """
        loading = {find_role(node) for node in unheard} - {find_role(node) for node in silent}
        waited = find_stalling_roles(facts.values())
        # Before lockstep begins no node reports to wait, but all wait for the vehicle
        # The last part of the name, since a role may have a robot before it
        first = {role for role in loading if role.rpartition('/')[2] == 'vehicle'}
        self._report_loading(sorted(first | (loading & set(waited))))
        suspects = [role for role in waited if role not in loading]
        blamed = self._blame.identify_stalling_nodes(suspects, silent, not unheard)
        # After a flight its simulator has stopped, and its nodes wait for it in vain
        blamed = [name for name in blamed if is_flying(facts, name)]
        # Nodes that share a process end one after the other
        if any(fact.values.get(ENDS_RUN) == str(True) for fact in facts.values()):
            blamed = []
        if blamed and blamed != self._named:
            sentence = f'No messages arrive from {", ".join(blamed)}.'
            self._say(sentence)
            self._tell(sentence)
        self._named = blamed

    def report_health(self, facts: Iterable[HealthFact]) -> None:
        """Report the faults of nodes and their ends, for a run whose nodes' lines nobody sees."""
        others = (fact for fact in facts if fact.task.partition(': ')[2] not in OTHER_TASKS)
        for line in self._log.update(others, time.monotonic()):
            self._say(f'{line.text.rstrip(".")}.')

    def _report_loading(self, loading: list[str]) -> None:
        """Report once which nodes the others wait for, if loading takes long."""
        if loading and not self._excused and time.monotonic() - self._begun > STARTING_TIME:
            self._excused = True
            self._say(
                f'Waiting for {", ".join(loading)} to load; '
                'the first flight compiles the model, which can take a minute.'
            )


def is_flying(facts: Mapping[str, HealthFact], node: str) -> bool:
    """Return whether a robot of a node, if it is simulated or replayed, has not ended."""
    robot, slash, _ = node.rpartition('/')
    going = [
        fact.values.get('outcome', outcome) == outcome
        for task, outcome in GOING.items()
        for name, fact in facts.items()
        # A node without a robot serves all
        if name.startswith(robot + slash) and name.endswith(task)
    ]
    return not going or any(going)
