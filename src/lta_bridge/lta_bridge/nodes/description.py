"""
The description node: it publishes the drone's shape and frames for RViz and other tools.

The vehicle's URDF is latched on `robot_description`. The vehicle's frame is published on /tf from
`odom` or the truth, and the frames of sensors and rotors on /tf_static, if tf2_msgs is installed
(no wheel has it; `make build` compiles it). With a scenario, its room and lamps are latched as
markers on `scene`, and `odom` is where the scenario starts the drone in `map`: nothing measures
that, so the drone's own drift moves `base_link`, not `odom`. No other node waits for this one.
"""

import math
from typing import Any, Literal

from geometry_msgs.msg import TransformStamped
from lta_bridge.live.frames import SceneFrame
from lta_bridge.live.messages import build_marker_array
from lta_bridge.live.room_shapes import draw_static_scene, MAP
from lta_bridge.urdf import build_urdf, list_fixed_frames
from lta_config.settings import setting, Settings
from lta_graph.health import HealthLevel
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_model.scenario import load_scenario, Scenario
from lta_model.start_offset import FAR
from lta_model.vehicle import load_vehicle
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from visualization_msgs.msg import MarkerArray

try:
    from tf2_msgs.msg import TFMessage
except ImportError:
    TFMessage = None

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
DEPTH = 100  # queue depth of /tf, as in tf2


class DescriptionSettings(Settings):
    """Parameters of the description node: the vehicle, and the topic of its pose."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    pose: Literal['odom', 'ground_truth/odom'] = setting(
        'odom', 'Topic with the pose of base_link to publish on /tf.', fixed=True
    )
    scene: str = setting(
        '', 'Scenario, name or file, whose room is drawn; none by default.', fixed=True
    )
    offset_x: float = setting(
        0.0, "Offset of the start from the scenario's along map x.", unit='m',
        low=-FAR, high=FAR, fixed=True,
    )  # fmt: skip
    offset_y: float = setting(
        0.0, "Offset of the start from the scenario's along map y.", unit='m',
        low=-FAR, high=FAR, fixed=True,
    )  # fmt: skip
    frame_prefix: str = setting(
        '', 'Prefix of all frames but map, such as lta1/, for several drones.', fixed=True
    )


class DescriptionNode(GraphNode):
    """Publish the URDF and, if tf2_msgs is installed, transforms."""

    def __init__(self) -> None:
        super().__init__('description')
        settings = NodeParameters(self, DescriptionSettings).value
        vehicle = load_vehicle(settings.vehicle)
        self._prefix = settings.frame_prefix
        scenario = load_scenario(settings.scene) if settings.scene else None
        if scenario is not None:
            self._scene = self.create_publisher(MarkerArray, 'scene', LATCHED)
            self._scene.publish(build_marker_array(draw_static_scene(scenario)))
        self._text = self.create_publisher(String, 'robot_description', LATCHED)
        self._text.publish(String(data=build_urdf(vehicle)))
        if TFMessage is None:
            text = 'only the URDF is published, not /tf: tf2_msgs is missing (see lta doctor)'
            self.health.report('frames', HealthLevel.OK, text)
            return
        self._tf = self.create_publisher(TFMessage, '/tf', DEPTH)
        self._static = self.create_publisher(TFMessage, '/tf_static', LATCHED)
        frames = list_fixed_frames(vehicle)
        if scenario is not None:
            offset = settings.offset_x, settings.offset_y
            frames.append(build_start_frame(scenario, offset))
        still = [self._add_prefix(to_fixed_transform(frame)) for frame in frames]
        self._static.publish(TFMessage(transforms=still))
        self.subscribe_topic(settings.pose, self._on_pose)
        self.health.report(
            'frames',
            HealthLevel.OK,
            f'the pose of base_link is published on /tf, from the topic {settings.pose}',
        )

    def _on_pose(self, odom: Any) -> None:  # noqa: ANN401 - a generated class
        self._tf.publish(TFMessage(transforms=[self._add_prefix(to_transform(odom))]))

    def _add_prefix(self, transform: TransformStamped) -> TransformStamped:
        """Add the prefix to the names of both frames; the map is common to all drones."""
        if transform.header.frame_id != MAP:
            transform.header.frame_id = self._prefix + transform.header.frame_id
        transform.child_frame_id = self._prefix + transform.child_frame_id
        return transform


def build_start_frame(scenario: Scenario, offset: tuple[float, float]) -> SceneFrame:
    """Return the frame of the drone's odometry: its pose at the start, moved by an offset. [m]"""
    x, y = (a + b for a, b in zip(scenario.start.position.vector, offset, strict=True))
    half = 0.5 * scenario.start.heading.si
    return SceneFrame(MAP, 'odom', (x, y, 0.0), (0.0, 0.0, math.sin(half), math.cos(half)))


def to_transform(odom: Odometry) -> TransformStamped:
    """Convert a pose to the transform from its frame to the vehicle's."""
    message = TransformStamped(header=odom.header, child_frame_id=odom.child_frame_id)
    place, goal = odom.pose.pose.position, message.transform.translation
    goal.x, goal.y, goal.z = place.x, place.y, place.z
    message.transform.rotation = odom.pose.pose.orientation
    return message


def to_fixed_transform(frame: SceneFrame) -> TransformStamped:
    """Return the static transform of a frame fixed to its parent."""
    message = TransformStamped(child_frame_id=frame.name)
    message.header.frame_id = frame.parent
    place, turn = message.transform.translation, message.transform.rotation
    place.x, place.y, place.z = frame.place
    turn.x, turn.y, turn.z, turn.w = frame.turn
    return message


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(DescriptionNode, args)
