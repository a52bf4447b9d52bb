# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Convert a tracker's messages to poses, and motion to Odometry."""

from importlib import import_module
import math
from typing import Any

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
from lta_config.errors import BadInput
from nav_msgs.msg import Odometry
import numpy as np
from numpy.typing import NDArray

POSES_PACKAGE = 'motion_capture_tracking_interfaces'  # the package of NamedPoseArray


def find_pose_type(name: str) -> Any:
    """Return the type of a topic with poses; raise `BadInput` if its package is missing."""
    if name != 'named_poses':
        return {'pose': PoseStamped, 'odometry': Odometry}[name]
    try:
        return import_module(f'{POSES_PACKAGE}.msg').NamedPoseArray
    except ModuleNotFoundError:
        raise BadInput(
            f'The type named_poses needs the messages of {POSES_PACKAGE}, which are not '
            'installed; build the package in your workspace, or use the type pose.'
        ) from None


def to_stamped_pose(message: Any, name: str) -> TrackerPose | None:
    """Return the pose in a message; of the body of that name, or None, in a NamedPoseArray."""
    if isinstance(message, Odometry):
        return from_odometry(message)
    if isinstance(message, PoseStamped):
        return from_pose(message)
    return next((from_pose(each) for each in message.poses if each.name == name), None)


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
