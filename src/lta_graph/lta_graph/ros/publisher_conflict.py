"""Detect other publishers on a node's outputs."""

from collections.abc import Mapping
from typing import final

from lta_graph.health import Health, HealthLevel
from rclpy.node import Node
from rclpy.publisher import Publisher

OTHERS = 'others'  # the health task
COMMON = {'/diagnostics', '/tf', '/tf_static'}  # shared by several nodes on purpose


@final
class PublisherConflict:
    """
    Report other publishers on the outputs of a node.

    `writers`: its outputs by relative name.
    """

    def __init__(self, node: Node, writers: Mapping[str, Publisher]) -> None:
        self._node = node
        self._writers = writers

    def report(self, health: Health) -> None:
        """Report a conflict, or that it has ended; nothing if there never was one."""
        shared = [
            name
            for name, writer in self._writers.items()
            # The node's own publisher counts as one
            if name not in COMMON and self._node.count_publishers(writer.topic_name) > 1
        ]
        if shared:
            words = f'{", ".join(shared)} ({self._format_other_nodes(shared)}); stop all but one'
            health.report(OTHERS, HealthLevel.ERROR, f'other nodes also publish {words}')
        elif OTHERS in health:
            health.report(
                OTHERS, HealthLevel.OK, 'no other node publishes the topics of this node'
            )

    def _format_other_nodes(self, shared: list[str]) -> str:
        """Return the names of the other nodes; a second node of the own name counts."""
        own, strangers = self._node.get_fully_qualified_name(), set[str]()
        for name in shared:
            publishers = self._node.get_publishers_info_by_topic(self._writers[name].topic_name)
            names = [f'{each.node_namespace.rstrip("/")}/{each.node_name}' for each in publishers]
            if own in names:
                names.remove(own)  # one only: a second is a namesake
            strangers.update(names)
        # The count may be newer than the discovery of the node's name
        return ', '.join(sorted(strangers)) or 'not yet known'
