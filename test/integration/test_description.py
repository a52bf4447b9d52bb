# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The description node in a graph: its URDF and its frames reach a viewer that comes late."""

from xml.etree import ElementTree

from frame_tree import resolve_all
from lta_bag.reader import read_bag
from lta_bridge.description.urdf import list_fixed_frames
from lta_model.vehicle import load_vehicle
from nav_msgs.msg import Odometry
import pytest
from rcl_interfaces.srv import ListParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from .peer import ended, Peer, start

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_a_viewer_that_comes_late_gets_the_urdf(domain_id):
    process = start('lta_bridge.nodes.description', '-p', 'vehicle:=gtmab')
    with Peer(domain_id) as peer:
        heard = []
        peer.node.create_subscription(String, 'robot_description', heard.append, LATCHED)
        peer.until(lambda: heard)
        assert ElementTree.fromstring(heard[0].data).get('name') == 'gtmab'
        # The URDF comes while the node is made; who answers a service works, and leaves in order.
        peer.ask(ListParameters, 'description/list_parameters')
    ended(process)


def test_frames_follow_the_vehicle_file_and_odom_if_asked(domain_id):
    words = (
        '-p', 'vehicle:=gtmab', '-p', 'scene:=lamp_room', '-p', 'frame_prefix:=lta1/',
        '-p', 'pose:=odom', '-p', 'map:=true',
    )  # fmt: skip
    process = start('lta_bridge.nodes.description', *words)
    with Peer(domain_id) as peer:
        scenes = []
        peer.node.create_subscription(MarkerArray, 'scene', scenes.append, LATCHED)
        moving, still = [], []
        peer.node.create_subscription(TFMessage, '/tf', moving.append, 100)
        peer.node.create_subscription(TFMessage, '/tf_static', still.append, LATCHED)
        odom = peer.publisher('odom')
        pose = Odometry(child_frame_id='base_link')
        pose.header.frame_id = 'odom'
        pose.pose.pose.position.x, pose.pose.pose.orientation.w = 1.5, 1.0

        peer.node.create_timer(0.02, lambda: odom.publish(pose))
        peer.until(lambda: moving and still and scenes)
        assert {'room', 'goal'} < {marker.ns for marker in scenes[0].markers}
        (moved,) = moving[0].transforms
        assert (moved.header.frame_id, moved.child_frame_id) == (
            'lta1/odom', 'lta1/base_link',
        )  # fmt: skip
        assert moved.transform.translation.x == 1.5
        fixed = {each.child_frame_id: each for each in still[0].transforms}
        wanted = list_fixed_frames(load_vehicle('gtmab'))
        (begin,) = (each for each in still[0].transforms if each.header.frame_id == 'map')
        assert fixed.pop('lta1/odom') == begin
        assert (begin.transform.translation.x, begin.transform.rotation.w) == (0.0, 1.0)
        assert set(fixed) == {f'lta1/{frame.name}' for frame in wanted}
        for frame in wanted:
            assert fixed[f'lta1/{frame.name}'].header.frame_id == f'lta1/{frame.parent}'
            place = fixed[f'lta1/{frame.name}'].transform.translation
            assert (place.x, place.y, place.z) == pytest.approx(frame.place)
    ended(process)


def test_a_flight_publishes_one_tree_and_nobody_who_flies_reads_truth_or_transforms(
    lta, domain_id, tmp_path
):
    flight = lta.start('launch', 'fly', f'bag:={tmp_path / "bag"}', 'frame_prefix:=lta1/')
    with Peer(domain_id) as peer:
        frames, odoms = {}, []

        def note(message):
            for item in message.transforms:
                parents = frames.setdefault(item.child_frame_id, set())
                parents.add(item.header.frame_id)

        still = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        peer.node.create_subscription(TFMessage, '/tf', note, 100)
        peer.node.create_subscription(TFMessage, '/tf_static', note, still)
        peer.hear('odom', odoms.append)
        peer.until(lambda: {'lta1/odom', 'lta1/base_link', 'lta1/imu_link'} <= frames.keys())
        peer.until(lambda: len(odoms) > 20)
        assert frames['lta1/odom'] == {'map'}
        assert frames['lta1/base_link'] == {'lta1/odom'}
        wanted = {f'lta1/{frame.name}' for frame in list_fixed_frames(load_vehicle('gtmab'))}
        assert {name for name, up in frames.items() if up == {'lta1/base_link'}} == wanted
        for topic in ('/tf', '/tf_static', '/lta1/ground_truth/odom'):
            readers = peer.node.get_subscriptions_info_by_topic(topic)
            assert {reader.node_name for reader in readers} - {peer.node.get_name()} == {
                'recorder'
            }
    flight.interrupt()
    assert flight.end() == 130
    found = resolve_all(read_bag(tmp_path / 'bag'), cut=True)
    assert {'map', 'lta1/odom', 'lta1/base_link', 'lta1/imu_link'} < found
