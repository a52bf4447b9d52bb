"""
The live node: it shows a running graph and a 3D scene in Foxglove; the viewer needs no ROS.

It subscribes to the topics of the table, but for those that it draws itself (`REPLACED`), and
publishes nothing, so it never delays the graph.
Periodic topics are shown at the rate of a screen; what is left out is counted in /diagnostics.
"""

from collections.abc import Callable
import time
from typing import Any, Final

from foxglove.messages import FrameTransforms, SceneUpdate
from geometry_msgs.msg import Vector3Stamped
from lta_bridge.bag.schemas import generate_definition
from lta_bridge.live.address import LOCAL, PORT
from lta_bridge.live.encoding import encode_frame_transforms, encode_scene_update
from lta_bridge.live.feed import RateLimiter, TopicThrottle
from lta_bridge.live.scene import LiveScene, SceneState
from lta_bridge.live.server import LiveServer
from lta_bridge.live.shapes import Three, Turn
from lta_bridge.log_time_assigner import read_stamp
from lta_config.settings import setting, Settings
from lta_config.topics import robot_topic
from lta_graph.health import HealthLevel
from lta_graph.ros.message_validation import decode_message, find_message_type
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.transforms import add_prefix
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy

import foxglove

MANY: Final = 100  # queue depth of aperiodic topics: each message may be from another node
DRAWN: Final = ('ground_truth/odom', 'odom', 'motors', 'light/bearing', 'wind')
REPLACED: Final = ('robot_description', 'scene', '/tf', '/tf_static')
DRAW_RATE: Final = 25.0  # Hz of wall time
PATH_RATE: Final = 2.0  # Hz; a long path has many points


class LiveSettings(Settings):
    """Parameters of the live node."""

    vehicle: str = setting('gtmab', 'Vehicle to draw: name or file.', fixed=True)
    scenario: str = setting('lamp_room', 'Scenario to draw: name or file.', fixed=True)
    host: str = setting(
        LOCAL, 'Address to listen on; 0.0.0.0 also accepts other computers.', fixed=True
    )
    port: int = setting(PORT, 'TCP port of the live view.', low=1, high=65535, fixed=True)


class LiveViewNode(GraphNode):
    """Show raw messages and a scene to viewers."""

    def __init__(self) -> None:
        super().__init__('live')
        settings = NodeParameters(self, LiveSettings).value
        self._robot = self.get_namespace().strip('/')
        # The scene of this node, at the true pose, takes the place of URDF, markers and transforms
        self._topics = [name for name in self.table.topics if name not in REPLACED]
        scenario = load_scenario(settings.scenario)
        self._scene = LiveScene(load_vehicle(settings.vehicle, scenario.air.density), scenario)
        self._feed = TopicThrottle(self.table)
        self._raw: dict[str, bytes] = {}
        self._torn = 0
        self._draw, self._path = RateLimiter(DRAW_RATE), RateLimiter(PATH_RATE)
        self._scene_topic, self._tf_topic = self._absolute_name('scene'), self._absolute_name('tf')
        title = f'LTA {self._robot}'
        self._server = LiveServer(title, settings.host, settings.port, self._list_channels())
        for name in self._topics:
            self._subscribe_topic(name)

    def _absolute_name(self, name: str) -> str:
        return robot_topic(self._robot, name) if self._robot else f'/{name.lstrip("/")}'

    def _list_channels(self) -> dict[str, tuple[str, foxglove.Schema]]:
        """Return the shown topics of the table by their full names, and the two of the scene."""
        channels = {}
        for name in self._topics:
            topic = self.table[name]
            text = generate_definition(topic.type).text.encode()
            schema = foxglove.Schema(name=topic.type, encoding='ros2msg', data=text)
            channels[self._absolute_name(name)] = ('cdr', schema)
        channels[self._scene_topic] = ('protobuf', SceneUpdate.get_schema())
        channels[self._tf_topic] = ('protobuf', FrameTransforms.get_schema())
        return channels

    def _subscribe_topic(self, name: str) -> None:
        topic = self.table[name]
        # Viewers need only the newest message of a periodic topic
        depth = 1 if topic.period_ns or name == '/clock' else MANY
        # Best effort never blocks a publisher, however slow the viewers are
        qos = QoSProfile(depth=depth, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.create_subscription(
            find_message_type(topic), name, self._build_raw_receiver(name), qos, raw=True
        )

    def _build_raw_receiver(self, name: str) -> Callable[[bytes], None]:
        absolute, server, feed = self._absolute_name(name), self._server, self._feed

        def show(data: bytes) -> None:
            when = feed.admit_message(name, data, has_viewers=server.has_viewers(absolute))
            if when is not None:
                server.send_message(absolute, data, when)

        def draw(data: bytes) -> None:
            self._raw[name] = data
            show(data)
            # The estimate sets the pace of the drawing
            if name == 'odom':
                self._draw_scene()

        def tell(data: bytes) -> None:
            show(data)
            now = read_stamp(data)
            if now is not None and now >= 0:
                server.broadcast_time(now)

        return draw if name in DRAWN else tell if name == '/clock' else show

    def _parse_newest(self, name: str) -> Any:  # noqa: ANN401 - a generated class, or None
        """Return the newest message of a topic; None if there is none or it is invalid."""
        data = self._raw.get(name)
        try:
            return data and decode_message(data, find_message_type(self.table[name]))
        except ValueError:  # a truncated message
            self._torn += 1
            del self._raw[name]
            return None

    def _collect_state(self) -> SceneState | None:
        """Return the state to draw from the newest messages; prefer the true pose."""
        pose = self._parse_newest('ground_truth/odom') or self._parse_newest('odom')
        motors, seen, wind = map(self._parse_newest, ('motors', 'light/bearing', 'wind'))
        if pose is None:
            return None
        place, turn = to_pose(pose)
        scene = SceneState(place, turn)
        return scene._replace(
            duties=dict(zip(motors.name, motors.duty, strict=False)) if motors else scene.duties,
            seen=to_vector(seen) if seen else scene.seen,
            wind=to_vector(wind) if wind else scene.wind,
        )

    def _draw_scene(self) -> None:
        """Send the scene to the viewers, at `DRAW_RATE` at most."""
        now, stamp, server = time.monotonic(), self._feed.now, self._server
        if not self._draw.try_acquire(now) or (state := self._collect_state()) is None:
            return
        entities = self._scene.draw_moving(state)
        if server.has_viewers(self._tf_topic):
            frames = [
                frame._replace(
                    parent=add_prefix(self.frame_prefix, frame.parent),
                    name=add_prefix(self.frame_prefix, frame.name),
                )
                for frame in self._scene.list_frames(state)
            ]
            server.send_message(self._tf_topic, encode_frame_transforms(frames, stamp), stamp)
        if server.has_viewers(self._scene_topic):
            if server.audience.has_new_viewer(self._scene_topic):
                # A new viewer needs the static scene once
                entities += [*self._scene.standing, self._scene.draw_path()]
            elif self._path.try_acquire(now):
                entities.append(self._scene.draw_path())
            entities = [
                item._replace(frame=add_prefix(self.frame_prefix, item.frame)) for item in entities
            ]
            server.send_message(self._scene_topic, encode_scene_update(entities, stamp), stamp)

    def update_health(self) -> None:
        """Report the number of viewers, and of sent and dropped messages."""
        sent, left_out = self._feed.sent, self._feed.left_out
        viewers = self._server.audience.viewer_count
        self.health.report(
            'view',
            HealthLevel.WARN if self._torn else HealthLevel.OK,
            (f'{viewers} viewers' if viewers != 1 else '1 viewer')
            + ('; some messages could not be read' if self._torn else ''),
            unreadable=self._torn,
            viewers=viewers,
            sent=sum(sent.values()),
            left_out=sum(left_out.values()),
            **{f'{name} left_out': count for name, count in left_out.items()},
        )

    def close(self) -> None:
        """Disconnect all viewers."""
        self._server.close()
        super().close()


def to_pose(message: Odometry) -> tuple[Three, Turn]:
    """Return position [m] and attitude (x y z w)."""
    p, q = message.pose.pose.position, message.pose.pose.orientation
    return (p.x, p.y, p.z), (q.x, q.y, q.z, q.w)


def to_vector(message: Vector3Stamped) -> Three:
    """Return the vector."""
    v = message.vector
    return v.x, v.y, v.z


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(LiveViewNode, args)
