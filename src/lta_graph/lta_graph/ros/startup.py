"""
Wait until all nodes of a graph are ready, before a flight or a replay begins.

Seeing both ends of a topic does not mean that they have matched. On a busy machine each pair takes
up to seconds, and in real time messages are lost until then. Only the publisher knows. So every
node reports in /diagnostics how many readers each output has matched, and the node that begins a
flight compares that with the graph.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
import os
import time
from typing import final, Self

from diagnostic_msgs.msg import DiagnosticArray
from lta_config.errors import BadInput
from lta_config.topics import TopicTable
from lta_graph.health import HealthLevel
from lta_graph.reach import RANGE_VARIABLE
from lta_graph.ros.node import GraphNode, LINKS_TASK
from rclpy.node import Node

COUNT_DIGITS = 10  # a reported count must have fewer; more is not a count of readers
DIAGNOSTICS_DEPTH = 100  # messages of all nodes together that may wait until the next poll


@final
class ReaderLinks:
    """
    Collect the numbers of matched readers that a drone's nodes report.

    Use it as `with ReaderLinks(node, table) as links: ...`; the subscription is destroyed on exit.

    `node`: the listening node; its namespace is that of the drone. `table`: gives the periodic
    topics.
    """

    def __init__(self, node: Node, table: TopicTable) -> None:
        self._node = node
        self._robot = node.get_namespace().strip('/')
        self._table = table
        self._topics = [name for name, row in table.topics.items() if row.period_ns]
        self._matched: dict[str, int] = {}
        self._subscription = node.create_subscription(
            DiagnosticArray, '/diagnostics', self._on_diagnostics, DIAGNOSTICS_DEPTH
        )

    def __enter__(self) -> Self:
        """Return this object."""
        return self

    def __exit__(self, *_: object) -> None:
        """Destroy the subscription."""
        self._node.destroy_subscription(self._subscription)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.hardware_id == self._robot and status.name.endswith(f': {LINKS_TASK}'):
                counts = {item.key: item.value for item in status.values}
                # Any node may publish on /diagnostics, so take only plausible counts
                self._matched |= {
                    k: int(v) for k, v in counts.items() if v.isdecimal() and len(v) < COUNT_DIGITS
                }

    def find_unready_topics(self, own: Mapping[str, int], awaited: Collection[str]) -> list[str]:
        """
        Return the topics of awaited nodes that do not report, or whose readers have not matched.

        `own`: matched readers of the node's own outputs, by topic. `awaited`: roles that must
        report. The topics of others count only if they are reported.
        """
        short = self.find_unmatched_topics(own)
        reported = self._matched | dict(own)
        silent = {
            name
            for name in self._topics
            if name not in reported and self._table[name].source in awaited
        }
        return [name for name in self._topics if name in silent or name in short]

    def find_unmatched_topics(self, own: Mapping[str, int]) -> list[str]:
        """
        Return the topics whose publisher has matched fewer readers than the graph has.

        `own`: as for `find_unready_topics`.
        """
        matched = self._matched | dict(own)
        return [
            name
            for name in self._topics
            if name in matched and matched[name] < self._node.count_subscribers(name)
        ]


SETTLED_TIME = 1.0  # wall seconds without a new endpoint after which a real-time flight begins


def wait_until_complete(
    node: GraphNode, list_missing: Callable[[], Sequence[str]], patience: float
) -> Iterator[None]:
    """
    Wait, in steps of the node's `run`, until no subscriber is missing.

    `node`: the waiting node; a stop signal ends the wait. `list_missing`: returns the names of
    those missing. `patience`: longest wait in wall time [s]. Raise `BadInput` if some are still
    missing then.
    """
    deadline = time.monotonic() + patience
    while node.running and (missing := list_missing()):
        if time.monotonic() > deadline:
            remedy = 'start them, or check discovery with "lta doctor"'
            if os.environ.get(RANGE_VARIABLE) == 'OFF':
                remedy = f'{RANGE_VARIABLE} is OFF, so no node finds another: unset it'
            raise BadInput(
                f'The node {node.get_name()} has waited {patience:g} s for these nodes: '
                f'{", ".join(missing)}; {remedy}.'
            )
        yield


def wait_until_settled(
    node: GraphNode, awaited: Collection[str], patience: float
) -> Iterator[None]:
    """
    Wait until the graph has not changed for `SETTLED_TIME`, and the known endpoints have matched.

    After `patience` the flight begins anyway, and warns in the task `start` which topics may not
    reach all readers.

    `node`: the waiting node; a stop signal ends the wait. `awaited`: roles that must report their
    readers. A user's own node does not, and is not waited for. `patience`: longest wait in wall
    time [s].
    """
    deadline = time.monotonic() + patience
    # Endpoints of a drone that still starts keep appearing; a stable number means all are there
    seen, since = count_endpoints(node), time.monotonic()
    with ReaderLinks(node, node.table) as links:
        while node.running and time.monotonic() - since < SETTLED_TIME:
            yield
            loose = links.find_unready_topics(node.count_readers(), awaited)
            now = count_endpoints(node)
            if time.monotonic() > deadline:
                words = (
                    f'begun before all subscribers of {", ".join(loose)} were found; the first '
                    'messages may be lost'
                )
                node.health.report('start', HealthLevel.WARN, words)
                return
            # Any change starts the quiet time again
            if loose or now != seen:
                seen, since = now, time.monotonic()


def count_endpoints(node: GraphNode) -> list[tuple[int, int]]:
    """Return the numbers of publishers and subscribers of each topic in the table."""
    return [(node.count_publishers(n), node.count_subscribers(n)) for n in node.table.topics]
