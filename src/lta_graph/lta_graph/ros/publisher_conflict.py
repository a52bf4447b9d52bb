# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Detect other publishers on a node's outputs, and unknown publishers of commands."""

from collections.abc import Mapping
import time
from typing import Final, final

from lta_config.topics import TopicTable
from lta_graph.health import Health, HealthLevel
from rclpy.node import Node
from rclpy.publisher import Publisher

CONFLICT_TASK = 'others'  # the health task
TELEOP = 'teleop'  # the role of which a second may be there: started again after a crash
# What moves a drone, directly or by the nodes that follow it
COMMAND_TOPICS: Final = (
    'motors',
    'setpoint/pose',
    'setpoint/velocity',
    'teleop/pose',
    'teleop/velocity',
    'teleop/held',
)
UNKNOWN_NODE = '_NODE_NAME_UNKNOWN_'  # of rmw, before the name of a publisher's node has arrived
NAMING = 2.0  # wall s for that name to arrive; a publisher without one for longer is unknown
SHARED_TOPICS = {'/diagnostics', '/tf', '/tf_static'}  # shared by several nodes on purpose


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
            if name not in SHARED_TOPICS and self._node.count_publishers(writer.topic_name) > 1
        ]
        if shared:
            words = f'{", ".join(shared)} ({self._format_other_nodes(shared)}); stop all but one'
            health.report(CONFLICT_TASK, HealthLevel.ERROR, f'other nodes also publish {words}')
        elif CONFLICT_TASK in health:
            health.report(
                CONFLICT_TASK, HealthLevel.OK, 'no other node publishes the topics of this node'
            )

    def _format_other_nodes(self, shared: list[str]) -> str:
        """Return the names of the other nodes; a second node of the own name counts."""
        own, strangers = self._node.get_fully_qualified_name(), set[str]()
        for name in shared:
            names = list_publishers(self._node, self._writers[name].topic_name)
            if own in names:
                names.remove(own)  # one only: a second is a namesake
            strangers.update(names)
        # The count may be newer than the discovery of the node's name
        return ', '.join(sorted(strangers)) or 'not yet known'


def list_publishers(node: Node, topic: str) -> list[str]:
    """Return the full names of the nodes that publish a topic, each as often as it does."""
    publishers = node.get_publishers_info_by_topic(topic)
    return [f'{each.node_namespace.rstrip("/")}/{each.node_name}' for each in publishers]


@final
class CommanderWatch:
    """
    Find nodes that publish commands and are not those of the topic table.

    A node is known by its name alone, as DDS without security tells nothing else: this finds a
    second node, a forgotten one and a stranger's, but not a stranger who waits until the node is
    gone and takes its name.

    `node`: the node that follows the commands. `table`: tells who publishes them.
    """

    def __init__(self, node: Node, table: TopicTable) -> None:
        self._node = node
        self._table = table
        self._nameless_since: dict[str, float] = {}

    def find_strangers(self) -> str:
        """Return the nodes, each with its topics, as a sentence; empty if there are none."""
        topics: dict[str, list[str]] = {}
        robot = self._node.get_namespace().rstrip('/')
        for topic in COMMAND_TOPICS:
            role = self._table[topic].source
            names = list_publishers(self._node, topic)
            owner = f'{robot}/{role}'
            if owner in names and role != TELEOP:
                names.remove(owner)  # one only: a second is a namesake
            for name in self._skip_new(topic, names):
                if name != owner or role != TELEOP:
                    topics.setdefault(name, []).append(topic)
        if not topics:
            return ''
        nodes = ', '.join(f'{name} ({", ".join(topics[name])})' for name in sorted(topics))
        return f'unknown nodes command the drone: {nodes}'

    def _skip_new(self, topic: str, names: list[str]) -> list[str]:
        """Return the names without those that have not arrived yet."""
        now = time.monotonic()
        complete = [name for name in names if not name.endswith(UNKNOWN_NODE)]
        if len(complete) == len(names):
            self._nameless_since.pop(topic, None)
        elif now - self._nameless_since.setdefault(topic, now) > NAMING:
            return names
        return complete
