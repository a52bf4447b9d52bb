# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Publish and receive the due times of a replay: one array with a labelled dimension per topic."""

import array
from collections.abc import Callable, Mapping, Sequence

from lta_config.topics import TopicTable
from lta_graph.lockstep import Inbox, RecordedSchedule
from lta_graph.ros.qos import select_profile
from rclpy.node import Node
from rclpy.subscription import Subscription
from std_msgs.msg import Int64MultiArray, MultiArrayDimension, MultiArrayLayout

DUE = 'replay/due'  # the topic


def from_due(due: Mapping[str, Sequence[int]]) -> Int64MultiArray:
    """Return the message with the due times of each topic [ns], one topic after the other."""
    # 'q' is a signed 64-bit integer; rclpy takes such an array without conversion
    times = array.array('q')
    for topic in due.values():
        times.extend(topic)
    rows = [
        MultiArrayDimension(label=name, size=len(topic), stride=1) for name, topic in due.items()
    ]
    return Int64MultiArray(layout=MultiArrayLayout(dim=rows), data=times)


def to_due(message: Int64MultiArray) -> dict[str, Sequence[int]]:
    """Return the due times of each topic from a player's message [ns]."""
    times: dict[str, Sequence[int]] = {}
    at = 0
    for row in message.layout.dim:
        times[row.label] = message.data[at : at + row.size]
        at += row.size
    return times


def subscribe_due_times(
    node: Node, table: TopicTable, then: Callable[[dict[str, Sequence[int]]], None]
) -> Subscription:
    """Return a subscription that calls `then` with the due times of a replay."""

    def receive_message(message: Int64MultiArray) -> None:
        then(to_due(message))

    return node.create_subscription(
        Int64MultiArray, DUE, receive_message, select_profile(table[DUE], True)
    )


def subscribe_inbox_schedule(
    node: Node, table: TopicTable, inbox: Inbox, then: Callable[[], None]
) -> Subscription:
    """Return a subscription that gives an inbox its due times and then calls `then`."""

    def set_schedule(due: dict[str, Sequence[int]]) -> None:
        inbox.turns = RecordedSchedule(table, due)
        then()

    return subscribe_due_times(node, table, set_schedule)
