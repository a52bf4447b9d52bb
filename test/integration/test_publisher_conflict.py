# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Who else publishes what a node does is told, by name, and forgotten once they are gone."""

from collections.abc import Callable, Iterator
import os

from lta_graph.health import Health, HealthLevel
from lta_graph.ros.publisher_conflict import CONFLICT_TASK, PublisherConflict
import pytest
from rclpy.context import Context
from rclpy.node import Node
from std_msgs.msg import Header
from waiting import wait_until

ROBOT = f'robot{os.getpid()}'  # of nobody else, whatever others left on the domain


@pytest.fixture
def node() -> Iterator[Callable[[str], Node]]:
    """Return a function that makes nodes of one process."""
    context, made = Context(), []
    context.init()

    def make(name: str) -> Node:
        made.append(Node(name, namespace=ROBOT, context=context))
        return made[-1]

    yield make
    for each in made:
        each.destroy_node()
    context.try_shutdown()


def test_a_stranger_is_named_until_it_is_gone(node):
    own, stranger, health = node('own'), node('stranger'), Health()
    writers = {name: own.create_publisher(Header, name, 10) for name in ('/diagnostics', 'imu')}
    conflict = PublisherConflict(own, writers)

    def told(level: HealthLevel) -> str:
        def looked() -> bool:
            conflict.report(health)
            return bool(health.facts) and health.facts[0].level == level

        wait_until(looked, f'level {level}', lambda: health.facts)
        return health.facts[0].message

    stranger.create_publisher(Header, '/diagnostics', 10)  # of every node
    conflict.report(health)
    assert CONFLICT_TASK not in health
    rival = stranger.create_publisher(Header, 'imu', 10)
    expected = f'other nodes also publish imu (/{ROBOT}/stranger); stop all but one'
    assert told(HealthLevel.ERROR) == expected
    conflict.report(health)
    assert health.facts[0].message == expected
    stranger.destroy_publisher(rival)
    assert told(HealthLevel.OK) == 'no other node publishes the topics of this node'
