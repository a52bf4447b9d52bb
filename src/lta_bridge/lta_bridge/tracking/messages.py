"""Convert a tracker's messages to poses, and motion to Odometry."""

import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import (
    Point,
    PoseStamped,
    PoseWithCovariance,
    Quaternion,
    TransformStamped,
    Vector3,
)
from lta_bridge.tracking.motion import TrackerMotion
from lta_bridge.tracking.pose import TrackerPose
from nav_msgs.msg import Odometry
import numpy as np
from numpy.typing import NDArray


def from_pose(message: PoseStamped | PoseWithCovariance) -> TrackerPose:
    """Return the pose."""
    return _build_pose(message.pose.position, message.pose.orientation)


def from_transform(message: TransformStamped) -> TrackerPose:
    """Return the pose of the child frame."""
    return _build_pose(message.transform.translation, message.transform.rotation)


def from_odometry(message: Odometry) -> TrackerPose:
    """Return the pose."""
    return from_pose(message.pose)


def _build_pose(p: Point | Vector3, q: Quaternion) -> TrackerPose:
    return TrackerPose((p.x, p.y, p.z), (q.x, q.y, q.z, q.w))


def to_odometry(stamp: Time, frame: str, motion: TrackerMotion) -> Odometry:
    """Return pose and twist with their variances; -1 means unknown."""
    message = Odometry(child_frame_id='base_link')
    message.header.stamp, message.header.frame_id = stamp, frame
    p, q = message.pose.pose.position, message.pose.pose.orientation
    v, w = message.twist.twist.linear, message.twist.twist.angular
    p.x, p.y, p.z = motion.pose.place
    q.x, q.y, q.z, q.w = motion.pose.turn
    v.x, v.y, v.z = motion.velocity
    w.x, w.y, w.z = motion.rates
    message.pose.covariance = _diagonal_covariance(motion.place_sigma, motion.turn_sigma)
    message.twist.covariance = _diagonal_covariance(motion.velocity_sigma, motion.rates_sigma)
    return message


def _diagonal_covariance(first: float, second: float) -> NDArray[np.float64]:
    """Return a diagonal 6x6 covariance from two standard deviations, each for three axes."""
    if math.isnan(first) or math.isnan(second):
        unknown = np.zeros(36)
        unknown[0] = -1.0
        return unknown
    return np.diag([first**2] * 3 + [second**2] * 3).ravel()
