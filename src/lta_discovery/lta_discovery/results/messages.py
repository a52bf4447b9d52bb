"""Build the ROS messages of the overlay bag: poses and position errors."""

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Vector3Stamped
from nav_msgs.msg import Odometry
import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import Header

FRAME = 'map'
SECOND = 1_000_000_000


def build_stamp(time_ns: int) -> Time:
    """Return a ROS time from nanoseconds."""
    seconds, rest = divmod(time_ns, SECOND)
    return Time(sec=seconds, nanosec=rest)


def build_pose_message(time_ns: int, values: NDArray[np.float64], child: str) -> Odometry:
    """
    Return the odometry message of a pose in `map` and body velocities.

    `values`, shape (13,): position, quaternion x y z w, velocity, rates [m, m/s, rad/s]. `child`:
    body frame: each model has its own.
    """
    message = Odometry(
        header=Header(stamp=build_stamp(time_ns), frame_id=FRAME), child_frame_id=child
    )
    at, turn = message.pose.pose.position, message.pose.pose.orientation
    at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w = map(float, values[:7])
    moving = message.twist.twist.linear, message.twist.twist.angular
    for vector, numbers in zip(moving, (values[7:10], values[10:13]), strict=True):
        vector.x, vector.y, vector.z = map(float, numbers)
    return message


def build_offset_message(time_ns: int, vector: NDArray[np.float64]) -> Vector3Stamped:
    """Return the error of a predicted position, in `map`. [m]"""
    message = Vector3Stamped(header=Header(stamp=build_stamp(time_ns), frame_id=FRAME))
    message.vector.x, message.vector.y, message.vector.z = map(float, vector)
    return message
