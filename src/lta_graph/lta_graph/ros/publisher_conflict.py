"""Who else publishes what a node does: one topic of two minds steers nobody well."""

from collections.abc import Mapping
from typing import final

from lta_graph.health import Health, HealthLevel
from rclpy.node import Node
from rclpy.publisher import Publisher

OTHERS = 'others'  # the task in which a node tells it
COMMON = '/diagnostics'  # of every node


@final
class PublisherConflict:
    """
    Looks at who else publishes the outputs of a node.

    Parameters
    ----------
    node : Node
        Whose outputs they are.
    writers : mapping of str to Publisher
        Its outputs, by what they are called.

    """

    def __init__(self, node: Node, writers: Mapping[str, Publisher]) -> None:
        self._node = node
        self._writers = writers

    def report(self, health: Health) -> None:
        """Report it; nothing until there was somebody."""
        shared = [
            name
            for name, writer in self._writers.items()
            if name != COMMON and self._node.count_publishers(writer.topic_name) > 1
        ]
        if shared:
            words = f'{", ".join(shared)} ({self._name_strangers(shared)}); stop all but one'
            health.report(OTHERS, HealthLevel.ERROR, f'published by others too: {words}')
        elif OTHERS in health:
            health.report(OTHERS, HealthLevel.OK, 'nobody else publishes the same')

    def _name_strangers(self, shared: list[str]) -> str:
        """Return which nodes they are; a namesake is another."""
        own, strangers = self._node.get_fully_qualified_name(), set[str]()
        for name in shared:
            known = self._node.get_publishers_info_by_topic(self._writers[name].topic_name)
            names = [f'{each.node_namespace.rstrip("/")}/{each.node_name}' for each in known]
            if own in names:
                names.remove(own)  # once
            strangers.update(names)
        return ', '.join(sorted(strangers)) or 'not yet known'
