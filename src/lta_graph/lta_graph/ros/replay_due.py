"""The turns of a replay on the wire: one array of all topics, labelled by its dimensions."""

import array
from collections.abc import Callable, Mapping, Sequence

from lta_config.topics import TopicTable
from lta_graph.inbox import Inbox
from lta_graph.lockstep import RecordedTurns
from lta_graph.ros.qos import select_profile
from rclpy.node import Node
from rclpy.subscription import Subscription
from std_msgs.msg import Int64MultiArray, MultiArrayDimension, MultiArrayLayout

DUE = 'replay/due'  # the topic


def from_due(due: Mapping[str, Sequence[int]]) -> Int64MultiArray:
    """Return when each message of each topic is due [ns]: a dimension a topic, in a row."""
    times = array.array('q')
    for topic in due.values():
        times.extend(topic)
    rows = [
        MultiArrayDimension(label=name, size=len(topic), stride=1) for name, topic in due.items()
    ]
    return Int64MultiArray(layout=MultiArrayLayout(dim=rows), data=times)


def to_due(message: Int64MultiArray) -> dict[str, Sequence[int]]:
    """Return when each message of each topic is due, as a player told it. [ns]"""
    found: dict[str, Sequence[int]] = {}
    at = 0
    for row in message.layout.dim:
        found[row.label] = message.data[at : at + row.size]
        at += row.size
    return found


def subscribe_due(
    node: Node, table: TopicTable, then: Callable[[dict[str, Sequence[int]]], None]
) -> Subscription:
    """Return a subscription by which a node learns what is due."""

    def receive(message: Int64MultiArray) -> None:
        then(to_due(message))

    return node.create_subscription(
        Int64MultiArray, DUE, receive, select_profile(table[DUE], True)
    )


def subscribe_turns(
    node: Node, table: TopicTable, inbox: Inbox, then: Callable[[], None]
) -> Subscription:
    """Return a subscription by which an inbox learns what is due, and do something then."""

    def set_turns(due: dict[str, Sequence[int]]) -> None:
        inbox.turns = RecordedTurns(table, due)
        then()

    return subscribe_due(node, table, set_turns)
