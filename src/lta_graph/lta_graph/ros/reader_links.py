"""
Tell whether the nodes of a drone have found each other, before what they say counts.

That we see a writer and its reader does not say that they have found each other: on a busy machine
that takes each pair up to seconds, and what is said before is lost in real time. Only the writer
knows. So every node tells in /diagnostics how many readers each of its topics has found, and
whoever begins a flight holds that against the graph that it sees itself.
"""

from collections.abc import Mapping
from types import TracebackType
from typing import final, Self

from diagnostic_msgs.msg import DiagnosticArray
from lta_config.topics import TopicTable
from rclpy.node import Node

LINKS = 'links'  # the task in which a node tells the readers of its topics
DIGITS = 10  # of a count that somebody tells
DEPTH = 100  # messages of all nodes together that may wait until the next look


@final
class ReaderLinks:
    """
    Hear how many readers a drone's nodes have found, from now on.

    `with Links(node, table) as links: ...` listens only so long; not while the node spins, since
    the subscription goes.

    Parameters
    ----------
    node : Node
        Who listens; its namespace is that of the drone.
    table : TopicTable
        Tells which topics have a rhythm, and therefore a writer.

    """

    def __init__(self, node: Node, table: TopicTable) -> None:
        self._node = node
        self._robot = node.get_namespace().strip('/')
        self._topics = [name for name, row in table.topics.items() if row.period_ns]
        self._found: dict[str, int] = {}
        self._subscription = node.create_subscription(
            DiagnosticArray, '/diagnostics', self._on_diagnostics, DEPTH
        )

    def __enter__(self) -> Self:
        """Listen for as long as the context lasts."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Listen no more."""
        self._node.destroy_subscription(self._subscription)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.hardware_id == self._robot and status.name.endswith(f': {LINKS}'):
                counts = {item.key: item.value for item in status.values}
                # Anybody may speak on /diagnostics, and anything.
                self._found |= {
                    k: int(v) for k, v in counts.items() if v.isdecimal() and len(v) < DIGITS
                }

    def find_unready_topics(self, own: Mapping[str, int]) -> list[str]:
        """
        Return the topics that not all of their readers would hear now, or that nobody writes.

        Parameters
        ----------
        own : mapping of str to int
            Readers that the node itself has found, by topic.

        """
        short = self.find_unmatched_topics(own)
        told = self._found | dict(own)
        return [name for name in self._topics if name not in told or name in short]

    def find_unmatched_topics(self, own: Mapping[str, int]) -> list[str]:
        """
        Return the topics whose writer knows of fewer readers than there are.

        Parameters
        ----------
        own : mapping of str to int
            As for `find_unready_topics`.

        """
        take = self._subscription.handle.take_message
        while (taken := take(DiagnosticArray, False)) is not None:
            self._on_diagnostics(taken[0])
        found = self._found | dict(own)
        return [
            name
            for name in self._topics
            if name in found and found[name] < self._node.count_subscribers(name)
        ]
