"""What is wrong with a running graph: who holds it up, told once it is sure, and what ails."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
import math
import re
import time
from typing import final

from lta_graph.health import HealthFact, HealthLevel
from lta_graph.stall_attribution import find_role, find_stalled_roles, INPUTS

FLIGHT = 'simulator: flight'  # the fact on how a simulated flight stands
PLAYBACK = 'player: playback'  # and on how a replay does
GOING = {FLIGHT: 'flying', PLAYBACK: 'playing'}  # their outcomes until they end
SETTLE = 0.5  # wall seconds; nodes look at their inputs at different moments
DISCOVERY = 4.0  # wall seconds; while some nodes have not been found yet, the others mislead
FIGURE = re.compile(r'[0-9.]+')
REPEATED = 10.0  # wall seconds in which an error that comes and goes is told twice, then counted
AWAY = 1.0  # wall seconds without an error after which it is another one
ELSEWHERE = (INPUTS, 'processes')  # tasks whose errors have sentences of their own
START = 8.0  # wall seconds that nodes take to load on a busy machine; longer is worth a word


@final
class StallDetector:
    """
    Turn what is heard of the nodes into names.

    A node that hangs falls silent, and is named at once. One that goes on to report and yet does
    not answer is found by what the others wait for, which takes a moment to settle.

    Attributes
    ----------
    standing : float
        For how long somebody has held the graph up. [wall s]

    """

    def __init__(self) -> None:
        self._suspects: list[str] = []
        self._changed = self._well = time.monotonic()
        self.standing = 0.0

    def identify_stalled(
        self, suspects: list[str], silent: list[str], all_reporting: bool
    ) -> list[str]:
        """
        Return whom to name.

        Parameters
        ----------
        suspects : list of str
            For whom others say that they wait.
        silent : list of str
            Nodes that run and are no longer heard.
        all_heard : bool
            Whether every node that runs has been heard.

        """
        now = time.monotonic()
        if suspects != self._suspects:
            self._suspects, self._changed = suspects, now
        if not suspects and not silent:
            self._well = now
        self.standing = now - self._well
        settled = now - self._changed > (SETTLE if all_reporting else DISCOVERY)
        return silent or (suspects if settled else [])


@final
@dataclass(slots=True)
class NodeError:
    """
    One error of a node: when it was said and last seen [wall s], and how often it came back.

    The first time it comes back is said at once: a hiccup before a fault must not hide the fault.
    """

    said: float
    seen: float
    text: str
    back: bool = False  # whether that has been said of it
    again: int = 0
    here: bool = True


@final
class StallMonitor:
    """
    Name who holds a running graph up, each time that somebody else does, and tell what ails.

    Parameters
    ----------
    say : callable
        Gets the sentence.
    tell : callable
        Gets those sentences as well that nobody in the graph can know: who is silent.

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
    def stall_time(self) -> float:
        """For how long somebody has held the graph up. [wall s]"""
        return self._blame.standing

    def update(
        self, facts: Mapping[str, HealthFact], silent: list[str], unheard: Collection[str] = ()
    ) -> None:
        """
        Look at what the nodes say, and name the culprits when they are others than before.

        Parameters
        ----------
        facts : mapping of str to Fact
            The newest facts, as `DiagnosticsListener` has them.
        silent : list of str
            Nodes that run and are no longer heard, or have not been for too long.
        unheard : collection of str
            Nodes that run and have not been heard yet: they load, and hold nobody up.

        """
        loading = {find_role(node) for node in unheard} - {find_role(node) for node in silent}
        waited = find_stalled_roles(facts.values())
        # Before a lockstep begins nobody says that it waits, and all do: for the vehicle.
        first = {role for role in loading if role.rpartition('/')[2] == 'vehicle'}
        self._report_loading(sorted(first | (loading & set(waited))))
        suspects = [role for role in waited if role not in loading]
        blamed = self._blame.identify_stalled(suspects, silent, not unheard)
        # Once a flight is over its simulator stops, and all its nodes wait for that in vain.
        blamed = [name for name in blamed if is_flying(facts, name)]
        if blamed and blamed != self._named:
            sentence = f'Nothing comes from {", ".join(blamed)}.'
            self._say(sentence)
            self._tell(sentence)
        self._named = blamed
        self._report_errors(facts.values())

    def _report_errors(self, facts: Iterable[HealthFact]) -> None:
        """Say what nodes call an error, each once in a while; what came back since is counted."""
        now = time.monotonic()
        found: dict[str, str] = {}
        for fact in facts:
            node, _, task = fact.task.partition(': ')
            if fact.level == HealthLevel.ERROR and task not in ELSEWHERE:
                error = f'{node}: {FIGURE.sub("#", fact.message)}'
                found[error] = f'{node}: {fact.message.rstrip(".")}'
        for error, text in found.items():
            known = self._ailing.get(error)
            away = math.inf if known is None else now - known.seen
            if known is None or away > REPEATED or (away > AWAY and not known.back):
                self._report_repeats(error)
                self._say(f'{text}.')
                self._ailing[error] = NodeError(now, now, text, back=away <= REPEATED)
            else:
                known.again += not known.here
                known.seen, known.text = now, text
        for error, known in self._ailing.items():
            known.here = error in found
            if known.again and now - known.said > REPEATED:
                self._report_repeats(error)
                known.said, known.again = now, 0

    def _report_repeats(self, error: str) -> None:
        """Say how often an error came back since it was said, if it did."""
        known = self._ailing.get(error)
        if known is not None and known.again:
            times = 'once' if known.again == 1 else f'{known.again} times'
            self._say(f'{known.text} (again {times} in {time.monotonic() - known.said:.0f} s).')

    def _report_loading(self, loading: list[str]) -> None:
        """Say once for whom the others wait while they load, when that takes long."""
        if loading and not self._excused and time.monotonic() - self._begun > START:
            self._excused = True
            self._say(
                f'Waiting for {", ".join(loading)} to load; '
                'the first flight compiles the model, which can take a minute.'
            )


def is_flying(facts: Mapping[str, HealthFact], node: str) -> bool:
    """Tell whether what plays a node's robot, if anything, has not said how it ended."""
    robot, slash, _ = node.rpartition('/')
    told = {task: facts.get(robot + slash + task) for task in GOING}
    return all(
        fact is None or fact.values.get('outcome', GOING[task]) == GOING[task]
        for task, fact in told.items()
    )
