"""
Check that the publishers and subscribers of a drone have matched, before a flight begins.

Seeing both ends of a topic does not mean that they have matched. On a busy machine each pair takes
up to seconds, and in real time messages are lost until then. Only the publisher knows. So every
node reports in /diagnostics how many readers each output has matched, and the node that begins a
flight compares that with the graph.
"""

from collections.abc import Collection, Mapping
from typing import final, Self

from diagnostic_msgs.msg import DiagnosticArray
from lta_config.topics import TopicTable
from rclpy.node import Node

LINKS_TASK = 'links'  # health task with the number of readers of each output
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
