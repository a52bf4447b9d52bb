"""Transforms on /tf, by hand."""

import math

from builtin_interfaces.msg import Time
from lta_graph.ros.transforms import build_transform, from_odometry, from_start
from nav_msgs.msg import Odometry
import pytest
from scipy.spatial.transform import Rotation


def test_the_map_is_common_to_all_robots():
    message = build_transform(Time(sec=3), ('map', 'odom'), (1, 2, 3), (0, 0, 0, 1), 'lta2/')
    assert (message.header.frame_id, message.child_frame_id) == ('map', 'lta2/odom')
    assert message.header.stamp.sec == 3


def test_a_pose_becomes_the_transform_between_its_frames():
    odom = Odometry(child_frame_id='base_link')
    odom.header.frame_id, odom.header.stamp.sec = 'odom', 7
    odom.pose.pose.position.x, odom.pose.pose.position.z = 1.0, 3.0
    odom.pose.pose.orientation.w, odom.pose.pose.orientation.z = 0.6, 0.8
    (moved,) = from_odometry(odom).transforms
    assert (moved.header, moved.child_frame_id) == (odom.header, 'base_link')
    assert (moved.transform.translation.x, moved.transform.translation.z) == (1.0, 3.0)
    assert moved.transform.rotation == odom.pose.pose.orientation
    (moved,) = from_odometry(odom, 'lta1/').transforms
    assert (moved.header.frame_id, moved.child_frame_id) == ('lta1/odom', 'lta1/base_link')


def test_odom_is_on_the_floor_below_the_start_with_its_heading():
    half = math.radians(15.0)
    pose = (-2.5, 1.0, 0.4, 0.0, 0.0, math.sin(half), math.cos(half))
    (start,) = from_start(pose, 'lta1/').transforms
    assert (start.header.frame_id, start.child_frame_id) == ('map', 'lta1/odom')
    place, turn = start.transform.translation, start.transform.rotation
    assert (place.x, place.y, place.z) == (-2.5, 1.0, 0.0)
    nose = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w]).apply([1.0, 0.0, 0.0])
    assert nose == pytest.approx([math.sqrt(0.75), 0.5, 0.0])
