"""Hear /diagnostics from outside the graph, and speak there: for bars and for naming faults."""

from collections.abc import Iterable
from contextlib import ExitStack
import time
from types import TracebackType
from typing import final, Self

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lta_graph.health import HealthFact, HealthLevel
from lta_graph.interrupts import hold_interrupts
from lta_graph.ros.temporary_node import join_graph

DEPTH = 100  # messages of all nodes together that may wait until the next look
DISCOVERY = 10.0  # wall seconds after the first node in which DDS finds all, on a busy machine
LOADING = 300.0  # and in which all have spoken: they compile the model first, half a minute alone
TASK = 'launcher: processes'  # what is told of the nodes by whoever started them
SILENCE = 0.85  # wall seconds after which a node is missed: two of its reports, and some delay


@final
class DiagnosticsListener:
    """
    Collect the newest fact of every task: `with DiagnosticsListener('lta1') as listener: ...`.

    Parameters
    ----------
    robots : str
        Namespaces of the nodes to hear; /diagnostics is of all robots on the domain.

    Attributes
    ----------
    facts : dict of str to Fact
        By 'NODE: TASK', or 'ROBOT/NODE: TASK' where several robots are heard.

    """

    def __init__(self, *robots: str) -> None:
        heard = robots or ('lta1',)
        self._prefix = {name: f'{name}/' if name and len(heard) > 1 else '' for name in heard}
        self._robot = heard[0]
        self.facts: dict[str, HealthFact] = {}
        self._heard: dict[str, float] = {}
        self._begun: float | None = None
        self._complete: float | None = None

    def __enter__(self) -> Self:
        """Join the graph."""
        with ExitStack() as stack:
            node, self._executor = stack.enter_context(join_graph('lta_listener'))
            self._subscription = node.create_subscription(
                DiagnosticArray, '/diagnostics', self._on_diagnostics, DEPTH
            )
            self._publisher = node.create_publisher(DiagnosticArray, '/diagnostics', DEPTH)
            self._stack = stack.pop_all()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave the graph."""
        self._stack.close()

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        ours = [status for status in message.status if status.hardware_id in self._prefix]
        if ours:
            self._begun = self._begun or time.monotonic()
        for status in ours:
            values = {item.key: item.value for item in status.values}
            # Anybody may speak on /diagnostics; a level that there is not counts as the worst.
            level = HealthLevel(min(int.from_bytes(status.level, 'little'), HealthLevel.STALE))
            task = self._prefix[status.hardware_id] + status.name
            self.facts[task] = HealthFact(task, level, status.message, values)
            self._heard[task.partition(':')[0]] = time.monotonic()

    def poll(self, timeout: float) -> dict[str, HealthFact]:
        """Listen for a while [s] and return the newest fact of each 'NODE: TASK'."""
        with hold_interrupts():
            self._executor.spin_once(timeout_sec=timeout)
            # The executor hands out one message at a time, and more may have come.
            while (
                taken := self._subscription.handle.take_message(DiagnosticArray, False)
            ) is not None:
                self._on_diagnostics(taken[0])
        return self.facts

    def publish_error(self, sentence: str) -> None:
        """Say at the level of an error what is wrong with a node: who records must hear it."""
        status = DiagnosticStatus(
            level=DiagnosticStatus.ERROR, name=TASK, message=sentence, hardware_id=self._robot
        )
        self._publisher.publish(DiagnosticArray(status=[status]))

    def find_silent(self, nodes: Iterable[str]) -> list[str]:
        """Return which of some nodes are no longer heard, or never were, in alphabetical order."""
        now = time.monotonic()
        begun = self._begun or now
        return sorted(
            name
            for name in nodes
            if now - self._heard.get(name, begun + LOADING - SILENCE) > SILENCE
        )

    def find_pending(self, nodes: Iterable[str]) -> list[str]:
        """Return which of some nodes have not been heard yet: they load, or are still sought."""
        return sorted(set(nodes) - self._heard.keys())

    def is_settled(self, nodes: Iterable[str]) -> bool:
        """
        Tell whether silence means something.

        While others still load, a node that runs may get no turn for a second. So all of some
        nodes must have been heard, and have had the time to report again.
        """
        now = time.monotonic()
        patient = self._begun is not None and now - self._begun > DISCOVERY
        if self._complete is None and (patient or not self.find_pending(nodes)):
            self._complete = now
        return self._complete is not None and now - self._complete > SILENCE
