# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Transforms on /tf, by hand."""

import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Vector3Stamped
from lta_graph.ros.transforms import build_transform, from_odometry, from_start, prefix_frames
from nav_msgs.msg import Odometry
import pytest
from scipy.spatial.transform import Rotation
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage


def test_the_frames_of_a_robot_have_its_prefix_once_and_the_map_is_common_to_all():
    message = build_transform(Time(sec=3), ('map', 'odom'), (1, 2, 3), (0, 0, 0, 1))
    odom = Odometry(child_frame_id='base_link')
    odom.header.frame_id, wind = 'odom', Vector3Stamped()
    for each in (TFMessage(transforms=[message]), odom, odom, wind, String()):
        prefix_frames('lta2/', each)
    assert (message.header.frame_id, message.child_frame_id) == ('map', 'lta2/odom')
    assert message.header.stamp.sec == 3
    assert (odom.header.frame_id, odom.child_frame_id) == ('lta2/odom', 'lta2/base_link')
    assert wind.header.frame_id == ''


def test_a_pose_becomes_the_transform_between_its_frames():
    odom = Odometry(child_frame_id='base_link')
    odom.header.frame_id, odom.header.stamp.sec = 'odom', 7
    odom.pose.pose.position.x, odom.pose.pose.position.z = 1.0, 3.0
    odom.pose.pose.orientation.w, odom.pose.pose.orientation.z = 0.6, 0.8
    (moved,) = from_odometry(odom).transforms
    assert (moved.header, moved.child_frame_id) == (odom.header, 'base_link')
    assert (moved.transform.translation.x, moved.transform.translation.z) == (1.0, 3.0)
    assert moved.transform.rotation == odom.pose.pose.orientation


def test_odom_is_on_the_floor_below_the_start_with_its_heading():
    half = math.radians(15.0)
    pose = (-2.5, 1.0, 0.4, 0.0, 0.0, math.sin(half), math.cos(half))
    (start,) = from_start(pose).transforms
    assert (start.header.frame_id, start.child_frame_id) == ('map', 'odom')
    place, turn = start.transform.translation, start.transform.rotation
    assert (place.x, place.y, place.z) == (-2.5, 1.0, 0.0)
    nose = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w]).apply([1.0, 0.0, 0.0])
    assert nose == pytest.approx([math.sqrt(0.75), 0.5, 0.0])
