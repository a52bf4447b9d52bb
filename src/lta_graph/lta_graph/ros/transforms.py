# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the transforms of /tf and /tf_static, and name the frames of one robot of several."""

from collections.abc import Sequence
from typing import Any, Final

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

MAP_FRAME: Final = 'map'
ODOM: Final = 'odom'


def add_prefix(prefix: str, frame: str) -> str:
    """Return a frame's name with the prefix of its robot, once; all robots share the map."""
    return frame if frame in ('', MAP_FRAME) or frame.startswith(prefix) else prefix + frame


def prefix_frames(prefix: str, message: Any) -> None:
    """Give the frames that a message names the prefix of its robot."""
    if hasattr(message, 'header'):
        message.header.frame_id = add_prefix(prefix, message.header.frame_id)
    if hasattr(message, 'child_frame_id'):
        message.child_frame_id = add_prefix(prefix, message.child_frame_id)
    for transform in getattr(message, 'transforms', ()):
        prefix_frames(prefix, transform)


def build_transform(
    stamp: Time,
    frames: tuple[str, str],
    place: Sequence[float],
    turn: Sequence[float],
) -> TransformStamped:
    """
    Return the transform between two frames.

    Parameters
    ----------
    frames : tuple of str
        Parent and child.
    place : sequence of 3 floats
        The origin of the child in the parent. [m]
    turn : sequence of 4 floats
        The attitude of the child in the parent, x y z w.

    """
    parent, child = frames
    message = TransformStamped()
    message.child_frame_id = child
    message.header.stamp, message.header.frame_id = stamp, parent
    moved, turned = message.transform.translation, message.transform.rotation
    moved.x, moved.y, moved.z = place
    turned.x, turned.y, turned.z, turned.w = turn
    return message


def from_start(pose: Sequence[float], prefix: str = '') -> TFMessage:
    """
    Return where the odometry of a drone begins in the map: on the floor below its start.

    `pose`: place [m] and attitude (x y z w) of a level drone at its start, sequence of 7 floats.
    `prefix`: of the drone's frames.
    """
    x, y, _, *turn = pose
    # The estimate counts height from the floor, distance and heading from the start. A fixed frame
    # holds at all times, so its stamp is zero.
    return TFMessage(
        transforms=[build_transform(Time(), (MAP_FRAME, prefix + ODOM), (x, y, 0.0), turn)]
    )


def from_odometry(odom: Odometry) -> TFMessage:
    """Return the pose of an odometry message as the transform between its frames."""
    p, q = odom.pose.pose.position, odom.pose.pose.orientation
    frames = odom.header.frame_id, odom.child_frame_id
    place, turn = (p.x, p.y, p.z), (q.x, q.y, q.z, q.w)
    return TFMessage(transforms=[build_transform(odom.header.stamp, frames, place, turn)])
