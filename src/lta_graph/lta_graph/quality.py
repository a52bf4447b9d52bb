# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Quality of service by topic: one profile in real time, another in lockstep.

Real time uses the profiles of REP-2003: publishers are reliable, and our nodes read sensors best
effort. In lockstep no message may be lost, and a node that joins late must still get the first
one. So every repeatable topic is reliable, transient local and deep.
Plain data, for programs without rclpy; `lta_graph.ros.qos` returns the same as rclpy's profiles.
"""

from typing import Final, Literal, NamedTuple

from lta_config.topics import Qos, Topic


class QualityOfService(NamedTuple):
    """A keep-last profile in the words of rosbag2."""

    depth: int
    reliability: Literal['reliable', 'best_effort'] = 'reliable'
    durability: Literal['volatile', 'transient_local'] = 'volatile'


REAL_TIME: Final[dict[Qos, QualityOfService]] = {
    'sensor': QualityOfService(5),
    'command': QualityOfService(1),
    'default': QualityOfService(10),
    'latched': QualityOfService(1, durability='transient_local'),
    'clock': QualityOfService(1),
}
LOCKSTEP_HISTORY_NS = 20_000_000_000  # of graph time: how far a slow reader may fall behind


def select_quality(topic: Topic, lockstep: bool) -> QualityOfService:
    """Return the quality that the publishers of a topic offer."""
    # Other topics are one-off events that a late node must not get again
    if not (lockstep and topic.repeatable):
        return REAL_TIME[topic.qos]
    depth = LOCKSTEP_HISTORY_NS // topic.period_ns if topic.period_ns else 100
    return QualityOfService(depth, durability='transient_local')
