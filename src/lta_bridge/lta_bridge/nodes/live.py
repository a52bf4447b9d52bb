# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The live node: it shows a running graph in Foxglove; the viewer needs no ROS.

It subscribes to the topics of the table, serves them as they are on the wire and publishes
nothing, so it never delays the graph. Drone, room and frames are drawn by the viewer, as RViz
does, from `robot_description`, `scene`, /tf and /tf_static.
A viewer that is slow gets the newest messages of periodic topics.
"""

from collections import defaultdict, deque
from collections.abc import Callable
from typing import Final, Unpack

import foxglove
from lta_bag.schemas import generate_definition
from lta_bridge.live.server import LiveServer
from lta_bridge.log_time_assigner import LogTimeAssigner, read_stamp
from lta_bridge.parameters import LiveSettings
from lta_config.topics import robot_topic, Topic
from lta_graph.health import HealthLevel
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

EVENT_DEPTH: Final = 100  # queue depth of aperiodic topics: each message may be from another node


def is_sent_once(topic: Topic) -> bool:
    """Return whether a viewer that comes later needs the messages of a topic that came before."""
    return topic.qos == 'latched' and not topic.period_ns


def select_viewer_profile(name: str, topic: Topic) -> QoSProfile:
    """Return the profile that the view requests of a topic."""
    if is_sent_once(topic):
        return QoSProfile(depth=EVENT_DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    # Viewers need only the newest message of a periodic topic
    depth = 1 if topic.period_ns or name == '/clock' else EVENT_DEPTH
    # Best effort never blocks a publisher, however slow the viewers are
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.BEST_EFFORT)


class LiveViewNode(GraphNode):
    """Show raw messages to viewers."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('live', **options)
        settings = NodeParameters(self, LiveSettings).value
        self._robot = self.get_namespace().strip('/')
        self._books, self._sent = LogTimeAssigner(self.table, lockstep=False), 0
        # By absolute name: what was sent once, for viewers that come later
        self._early: defaultdict[str, deque[bytes]] = defaultdict(
            lambda: deque(maxlen=EVENT_DEPTH)
        )
        title = f'LTA {self._robot}'
        self._server = LiveServer(title, settings.host, settings.port, self._list_channels())
        for name, topic in self.table.topics.items():
            self.create_subscription(
                find_message_type(topic),
                name,
                self._build_raw_receiver(name),
                select_viewer_profile(name, topic),
                raw=True,
            )

    def _absolute_name(self, name: str) -> str:
        return robot_topic(self._robot, name) if self._robot else f'/{name.lstrip("/")}'

    def _list_channels(self) -> dict[str, tuple[str, foxglove.Schema]]:
        """Return encoding and schema of the topics by their full names."""
        channels = {}
        for name, topic in self.table.topics.items():
            text = generate_definition(topic.type).text.encode()
            schema = foxglove.Schema(name=topic.type, encoding='ros2msg', data=text)
            channels[self._absolute_name(name)] = ('cdr', schema)
        return channels

    def _build_raw_receiver(self, name: str) -> Callable[[bytes], None]:
        absolute, server, books = self._absolute_name(name), self._server, self._books

        def show(data: bytes) -> None:
            when = books.assign_log_time(name, data)
            if server.has_viewers(absolute):
                server.send_message(absolute, data, when)
                self._sent += 1

        def keep(data: bytes) -> None:
            self._early[absolute].append(data)
            show(data)

        def tell(data: bytes) -> None:
            show(data)
            now = read_stamp(data)
            if now is not None and now >= 0:
                server.broadcast_time(now)

        return keep if is_sent_once(self.table[name]) else tell if name == '/clock' else show

    def update_health(self) -> None:
        """Send newcomers what came before them, and report what was sent."""
        for absolute, messages in self._early.items():
            if self._server.audience.has_new_viewer(absolute):
                for data in messages:
                    self._server.send_message(absolute, data, self._books.now)
        viewers = self._server.audience.viewer_count
        self.health.report(
            'view',
            HealthLevel.OK,
            f'{viewers} viewers' if viewers != 1 else '1 viewer',
            viewers=viewers,
            sent=self._sent,
        )

    def close(self) -> None:
        """Disconnect all viewers."""
        self._server.close()
        super().close()


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(LiveViewNode, args)
