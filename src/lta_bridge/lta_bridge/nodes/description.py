"""
The description node: it publishes the drone's shape and frames for RViz and other tools.

The vehicle's URDF is latched on `robot_description`. The vehicle's frame is published on /tf from
`odom` or the truth, and the frames of sensors and rotors on /tf_static, if tf2_msgs is installed
(no wheel has it; `make build` compiles it). No other node waits for this one.
"""

from typing import Any, Literal

from geometry_msgs.msg import TransformStamped
from lta_bridge.live.frames import SceneFrame
from lta_bridge.urdf import build_urdf, list_fixed_frames
from lta_config.settings import setting, Settings
from lta_graph.health import HealthLevel
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_model.vehicle import load_vehicle
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

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


class DescriptionNode(GraphNode):
    """Publish the URDF and, if tf2_msgs is installed, transforms."""

    def __init__(self) -> None:
        super().__init__('description')
        settings = NodeParameters(self, DescriptionSettings).value
        vehicle = load_vehicle(settings.vehicle)
        self._text = self.create_publisher(String, 'robot_description', LATCHED)
        self._text.publish(String(data=build_urdf(vehicle)))
        if TFMessage is None:
            text = 'only the URDF is published, not /tf: tf2_msgs is missing (see lta doctor)'
            self.health.report('frames', HealthLevel.OK, text)
            return
        self._tf = self.create_publisher(TFMessage, '/tf', DEPTH)
        self._static = self.create_publisher(TFMessage, '/tf_static', LATCHED)
        still = [to_fixed_transform(frame) for frame in list_fixed_frames(vehicle)]
        self._static.publish(TFMessage(transforms=still))
        self.subscribe_topic(settings.pose, self._on_pose)
        self.health.report(
            'frames',
            HealthLevel.OK,
            f'the pose of base_link is published on /tf, from the topic {settings.pose}',
        )

    def _on_pose(self, odom: Any) -> None:  # noqa: ANN401 - a generated class
        self._tf.publish(TFMessage(transforms=[to_transform(odom)]))


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
