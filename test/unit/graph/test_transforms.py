"""Transforms on /tf, by hand."""

from importlib.util import find_spec, module_from_spec
import math
import sys

from builtin_interfaces.msg import Time
from lta_config.topics import load_topic_table
from lta_graph.cdr_encoder import encode_cdr
from lta_graph.ros.message_validation import has_message_type
from lta_graph.ros.transforms import build_transform, from_odometry, from_start, TFMessage
from nav_msgs.msg import Odometry
import pytest
from rosbags.typesys import get_typestore, Stores
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


def test_it_is_encoded_without_the_package_as_with_it(monkeypatch):
    """A machine without a compiler writes the same bags; rosbags reads the bytes."""
    pose = (1.0, 2.0, 0.0, 0.0, 0.0, 0.6, 0.8)
    data = encode_cdr(from_start(pose))
    monkeypatch.setitem(sys.modules, 'tf2_msgs.msg', None)  # as if it were not installed
    found = find_spec('lta_graph.ros.transforms')
    bare = module_from_spec(found)
    found.loader.exec_module(bare)
    assert bare.TFMessage is not TFMessage
    assert encode_cdr(bare.from_start(pose)) == data
    types = get_typestore(Stores.ROS2_JAZZY)
    (one,) = types.deserialize_cdr(data, 'tf2_msgs/msg/TFMessage').transforms
    assert (one.child_frame_id, one.transform.translation.y) == ('odom', 2.0)


def test_whether_a_message_is_installed_is_known_without_importing_it():
    table = load_topic_table()
    assert has_message_type(table['odom'])
    missing = table['/tf'].model_copy(update={'declared_type': 'no_such_msgs/msg/Thing'})
    assert not has_message_type(missing)
