# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A flight begins in real time once every writer has found the readers that the graph has."""

from collections.abc import Iterator

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import Vector3Stamped
from lta_config.topics import load_topic_table
from lta_graph.ros.node import GraphNode, LINKS_TASK
from lta_graph.ros.startup import ReaderLinks
import pytest
from rclpy.context import Context
from rclpy.executors import Executor, SingleThreadedExecutor
from waiting import wait_until

TOPICS = [name for name, row in load_topic_table().topics.items() if row.period_ns]
ROLES = load_topic_table().roles


@pytest.fixture
def node() -> Iterator[GraphNode]:
    """Return a node of lta1 that stands for all its nodes."""
    context = Context()
    context.init()
    node = GraphNode('links', namespace='lta1', context=context)
    yield node
    node.destroy_node()
    context.try_shutdown()


def told(robot: str, **readers: int) -> DiagnosticArray:
    """Return what a node tells of the readers of its topics."""
    values = [KeyValue(key=name, value=str(count)) for name, count in readers.items()]
    status = DiagnosticStatus(name=f'x: {LINKS_TASK}', hardware_id=robot, values=values)
    return DiagnosticArray(status=[status])


def await_loose(
    links: ReaderLinks, own: dict[str, int], wanted: list[str], executor: Executor
) -> None:
    """Wait until just these topics are loose."""
    wait_until(
        lambda: links.find_unready_topics(own, ROLES) == wanted,
        str(wanted),
        lambda: links.find_unready_topics(own, ROLES),
        step=lambda: executor.spin_once(0.05),
    )


def test_a_topic_is_loose_until_its_writer_has_found_every_reader_of_the_graph(node):
    out = node.create_publisher(DiagnosticArray, '/diagnostics', 10)
    rest = [name for name in TOPICS if name not in ('imu', 'wind')]
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    with ReaderLinks(node) as links:
        await_loose(links, {}, TOPICS, executor)
        wait_until(out.get_subscription_count, 'a reader of /diagnostics')
        out.publish(told('lta2', wind=0))  # another drone's
        out.publish(told('lta1', **dict.fromkeys(rest, 0)))
        await_loose(links, {'imu': 0}, ['wind'], executor)
        out.publish(told('lta1', wind=0))
        await_loose(links, {'imu': 0}, [], executor)
        reader = node.create_subscription(Vector3Stamped, 'wind', lambda _: None, 10)
        await_loose(links, {'imu': 0}, ['wind'], executor)
        out.publish(told('lta1', wind=1))
        await_loose(links, {'imu': 0}, [], executor)
        node.destroy_subscription(reader)
        assert links.find_unready_topics({}, ROLES) == ['imu']
        assert links.find_unready_topics({}, ['estimator']) == []
    assert not list(node.subscriptions)
