"""Build the ROS messages of the overlay bag: poses and position errors."""

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Vector3Stamped
from nav_msgs.msg import Odometry
import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import Header

FRAME = 'map'
SECOND_NS = 1_000_000_000


def build_pose_message(time_ns: int, pose: NDArray[np.float64], child: str) -> Odometry:
    """
    Return the odometry message of a pose in `map`.

    `pose`, shape (7,): position [m], quaternion x y z w. `child`: body frame.
    """
    message = Odometry(header=_build_header(time_ns), child_frame_id=child)
    at, turn = message.pose.pose.position, message.pose.pose.orientation
    at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w = map(float, pose)
    return message


def build_offset_message(time_ns: int, vector: NDArray[np.float64]) -> Vector3Stamped:
    """Return the error of a forecast position, in `map`. [m]"""
    message = Vector3Stamped(header=_build_header(time_ns))
    message.vector.x, message.vector.y, message.vector.z = map(float, vector)
    return message


def _build_header(time_ns: int) -> Header:
    seconds, rest = divmod(time_ns, SECOND_NS)
    return Header(stamp=Time(sec=seconds, nanosec=rest), frame_id=FRAME)
