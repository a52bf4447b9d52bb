"""Report problems of a running graph: nodes that stall it, and errors that nodes report."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
import math
import re
import time
from typing import final

from lta_graph.health import ENDS_RUN, HealthFact, HealthLevel
from lta_graph.stall_attribution import find_role, find_stalling_roles, INPUTS

FLIGHT = 'simulator: flight'  # task with the state of a simulated flight
PLAYBACK = 'player: playback'  # task with the state of a replay
GOING = {FLIGHT: 'flying', PLAYBACK: 'playing'}  # their outcomes until they end
SETTLE = 0.5  # wall seconds; nodes check their inputs at different times
DISCOVERY = 4.0  # wall seconds to wait instead while some nodes are not discovered yet
FIGURE = re.compile(r'[0-9.]+')  # numbers, which may differ between reports of one error
REPEATED = 10.0  # wall seconds in which a recurring error is reported twice, then counted
AWAY = 1.0  # wall seconds without an error after which it counts as new
ELSEWHERE = (INPUTS, 'processes')  # tasks whose errors are reported elsewhere
START = 8.0  # wall seconds that nodes take to load on a busy machine; report if it takes longer


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
        settled = now - self._changed > (SETTLE if all_reporting else DISCOVERY)
        # Silence is certain, suspects may still change
        return silent or (suspects if settled else [])


@final
@dataclass(slots=True)
class NodeError:
    """
    One error of a node: times of its last message and report [wall s], and its repetitions.

    The first recurrence is reported at once, so that a brief error does not hide a later fault.
    """

    message_time: float
    report_time: float
    text: str
    back: bool = False  # whether the first recurrence has been reported
    again: int = 0  # recurrences since the last message
    here: bool = True  # whether it was present at the last update


@final
class StallMonitor:
    """
    Name the nodes that stall a graph, whenever they change, and report errors of nodes.

    `say`: gets each sentence. `tell`: also gets the sentences on stalls, which no node of the
    graph can report.
    """

    def __init__(
        self, say: Callable[[str], None], tell: Callable[[str], None] = lambda _: None
    ) -> None:
        self._say = say
        self._tell = tell
        self._ailing: dict[str, NodeError] = {}
        self._blame = StallDetector()
        self._named: list[str] = []
        self._begun = time.monotonic()
        self._excused = False

    @property
    def stall_duration(self) -> float:
        """Duration of the current stall. [wall s]"""
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
        self._report_errors(facts.values())

    def _report_errors(self, facts: Iterable[HealthFact]) -> None:
        """Report the errors of nodes, each once in a while, and count recurrences in between."""
        now = time.monotonic()
        errors: dict[str, str] = {}
        for fact in facts:
            node, _, task = fact.task.partition(': ')
            if fact.level == HealthLevel.ERROR and task not in ELSEWHERE:
                # The same error with other numbers is not a new one
                error = f'{node}: {FIGURE.sub("#", fact.message)}'
                errors[error] = f'{node}: {fact.message.rstrip(".")}'
        for error, text in errors.items():
            earlier = self._ailing.get(error)
            away = math.inf if earlier is None else now - earlier.report_time
            if earlier is None or away > REPEATED or (away > AWAY and not earlier.back):
                self._report_repeats(error)
                self._say(f'{text}.')
                self._ailing[error] = NodeError(now, now, text, back=away <= REPEATED)
            else:
                earlier.again += not earlier.here
                earlier.report_time, earlier.text = now, text
        for error, earlier in self._ailing.items():
            earlier.here = error in errors
            if earlier.again and now - earlier.message_time > REPEATED:
                self._report_repeats(error)
                earlier.message_time, earlier.again = now, 0

    def _report_repeats(self, error: str) -> None:
        """Report how often an error has recurred since its last message."""
        earlier = self._ailing.get(error)
        if earlier is not None and earlier.again:
            times = 'once' if earlier.again == 1 else f'{earlier.again} times'
            elapsed = time.monotonic() - earlier.message_time
            self._say(f'{earlier.text} (repeated {times} in {elapsed:.0f} s).')

    def _report_loading(self, loading: list[str]) -> None:
        """Report once which nodes the others wait for, if loading takes long."""
        if loading and not self._excused and time.monotonic() - self._begun > START:
            self._excused = True
            self._say(
                f'Waiting for {", ".join(loading)} to load; '
                'the first flight compiles the model, which can take a minute.'
            )


def is_flying(facts: Mapping[str, HealthFact], node: str) -> bool:
    """Return whether the robot of a node, if it is simulated or replayed, has not ended."""
    robot, slash, _ = node.rpartition('/')
    states = {task: facts.get(robot + slash + task) for task in GOING}
    return all(
        fact is None or fact.values.get('outcome', GOING[task]) == GOING[task]
        for task, fact in states.items()
    )
