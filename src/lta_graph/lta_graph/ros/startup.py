# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
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
from lta_config.topics import is_selected
from lta_graph.health import HealthLevel
from lta_graph.reach import RANGE_VARIABLE
from lta_graph.ros.node import GraphNode, LINKS_TASK
from rclpy.publisher import Publisher

COUNT_DIGITS = 10  # a reported count must have fewer; more is not a count of readers
RECORDER = 'recorder'  # name of the node
DESCRIPTION = 'description'  # role of a node that publishes once, so that nobody waits for more
DIAGNOSTICS_DEPTH = 100  # messages of all nodes together that may wait until the next poll


def list_topics(node: GraphNode) -> list[str]:
    """Return the topics of a node's robots, with their prefixes; absolute ones once."""
    return list(
        dict.fromkeys(
            name if name.startswith('/') else prefix + name
            for prefix in node.prefixes.values()
            for name in node.table.topics
        )
    )


@final
class ReaderLinks:
    """
    Collect the numbers of matched readers that the nodes of its robots report to a node.

    Use it as `with ReaderLinks(node) as links: ...`; the subscription is destroyed on exit. Topics
    have the prefixes that the node gives them.
    """

    def __init__(self, node: GraphNode) -> None:
        self._node = node
        self._topics = [name for name in list_topics(node) if node.find_row(name).period_ns]
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
            prefix = self._node.prefixes.get(status.hardware_id)
            if prefix is not None and status.name.endswith(f': {LINKS_TASK}'):
                counts = {item.key: item.value for item in status.values}
                # Any node may publish on /diagnostics, so take only plausible counts
                self._matched |= {
                    name if name.startswith('/') else prefix + name: int(count)
                    for name, count in counts.items()
                    if count.isdecimal() and len(count) < COUNT_DIGITS
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
            if name not in reported and self._node.find_row(name).source in awaited
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


def wait_for_graph(
    node: GraphNode,
    outputs: Mapping[str, Publisher],
    roles: Collection[str],
    recorded: str | None,
    patience: float,
) -> Iterator[None]:
    """
    Wait until the nodes that a flight needs are there, and in real time all endpoints matched.

    The arguments are those of `list_missing_nodes` and `wait_until_complete`.
    """
    yield from wait_until_complete(
        node, lambda: list_missing_nodes(node, outputs, roles, recorded), patience
    )
    if not node.lockstep:
        yield from wait_until_settled(node, roles, patience)


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
    with ReaderLinks(node) as links:
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
    return [(node.count_publishers(n), node.count_subscribers(n)) for n in list_topics(node)]


def list_missing_nodes(
    node: GraphNode,
    outputs: Mapping[str, Publisher],
    roles: Collection[str],
    recorded: str | None = None,
) -> list[str]:
    """
    Return the nodes that do not read a node's outputs yet, as roles with the prefixes of robots.

    `outputs`: the publishers by topic. `roles`: those to wait for; 'description' is there once it
    publishes. `recorded`: the setting `topics` of a recorder to wait for as well, if there is one.
    """
    missing: set[str] = set()
    robots = {prefix: robot for robot, prefix in node.prefixes.items()}
    for name, publisher in outputs.items():
        prefix, own = node.split_prefix(name)
        row = node.table[own]
        readers = {prefix + role for role in row.subscribers if role in roles}
        if publisher.get_subscription_count() < len(readers):
            missing |= readers
        if recorded is not None and is_selected(recorded, robots.get(prefix, ''), own, row):
            there = node.get_subscriptions_info_by_topic(publisher.topic_name)
            missing |= {RECORDER} - {reader.node_name for reader in there}
    for name in list_topics(node) if DESCRIPTION in roles else ():
        if node.find_row(name).source == DESCRIPTION and not node.count_publishers(name):
            missing.add(node.split_prefix(name)[0] + DESCRIPTION)
    return sorted(missing)
