"""Convert ROS messages for the live view's scene."""

from geometry_msgs.msg import Vector3Stamped
from lta_bridge.live.shapes import Three, Turn
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState


def to_pose(message: Odometry) -> tuple[Three, Turn]:
    """Return position [m] and attitude (x y z w)."""
    p, q = message.pose.pose.position, message.pose.pose.orientation
    return (p.x, p.y, p.z), (q.x, q.y, q.z, q.w)


def to_duties(message: JointState) -> dict[str, float]:
    """Return the duty of each actuator that has one. [1]"""
    return dict(zip(message.name, message.effort, strict=False))


def to_vector(message: Vector3Stamped) -> Three:
    """Return the vector."""
    v = message.vector
    return v.x, v.y, v.z
