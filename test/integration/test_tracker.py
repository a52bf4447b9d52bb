# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The tracker node in a graph: poses of a clock an hour ahead come out as the truth of now."""

import math

from geometry_msgs.msg import PoseStamped, TransformStamped
from lta_graph.health import HealthLevel
from lta_graph.ros.stamps import from_stamp, to_stamp
from nav_msgs.msg import Odometry
import pytest
from rclpy.qos import qos_profile_sensor_data
from tf2_msgs.msg import TFMessage

from .peer import ended, Peer, start

AHEAD = 3600 * 10**9
SPEED = 0.5


def posed(stamp, x):
    message = PoseStamped()
    message.header.stamp = stamp
    message.pose.position.x, message.pose.orientation.w = x, 1.0
    return (message,)


def framed(stamp, x):
    """Return a message with a frame that is followed, behind one that is not."""
    other, message = TransformStamped(child_frame_id='camera'), TransformStamped()
    other.header.stamp = message.header.stamp = stamp
    message.child_frame_id = 'drone'
    message.transform.translation.x, message.transform.rotation.w = x, 1.0
    return (TFMessage(transforms=[other, message]),)


def check_correction(peer, moved, heard):
    """
    Hold map -> odom to what a hand computes.

    The drone faces map x, and odom's y: so odom is turned by -90 degrees, and its origin is 2 m
    from the drone along odom's -x, which is +y in the map.
    """

    def corrected():
        return [
            (item, truth)
            for message in moved
            for item in message.transforms
            for truth in heard
            if item.child_frame_id == 'odom' and item.header.stamp == truth.header.stamp
        ]

    peer.until(lambda: len(corrected()) > 5)
    item, truth = corrected()[-1]
    assert item.header.frame_id == 'map'
    place, turn = item.transform.translation, item.transform.rotation
    there = truth.pose.pose.position
    assert (place.x, place.y, place.z) == pytest.approx((there.x, there.y + 2.0, there.z))
    assert turn.z / turn.w == pytest.approx(-1.0)


@pytest.mark.parametrize(
    ('words', 'topic', 'told'),
    [((), 'tracker/pose', posed), (('-p', 'frame:=drone'), '/tf', framed)],
)
def test_a_tracker_tells_the_truth_by_our_clock(domain_id, words, topic, told):
    body = ('-p', 'body:=[0.0, 0.0, 0.3, 0.0]')
    process = start('lta_bridge.nodes.tracker', *body, *words)
    offered = {
        'tracker/pose': (PoseStamped, qos_profile_sensor_data),
        '/tf': (TFMessage, 100),
    }[topic]
    with Peer(domain_id) as peer:
        heard, begun = [], []
        peer.hear('ground_truth/odom', heard.append)
        peer.hear_facts()
        moved = []
        peer.node.create_subscription(TFMessage, '/tf', moved.append, 100)
        estimates = peer.publisher('odom')
        poses = peer.offering(topic, *offered)
        clock = peer.node.get_clock()

        def say():
            now = clock.now().nanoseconds
            begun.append(now)
            for message in told(to_stamp(now + AHEAD), 1e-9 * SPEED * (now - begun[0])):
                poses.publish(message)
            # An estimate that is turned by 90 degrees, and has seen no motion
            odom = Odometry(child_frame_id='base_link')
            odom.header.stamp, odom.header.frame_id = to_stamp(now), 'odom'
            odom.pose.pose.position.x = 2.0
            odom.pose.pose.orientation.z = odom.pose.pose.orientation.w = math.sqrt(0.5)
            estimates.publish(odom)

        peer.node.create_timer(0.01, say)
        peer.until(lambda: len(heard) > 60)
        newest = heard[-1]
        assert newest.header.frame_id == 'map'
        assert newest.pose.pose.position.z == pytest.approx(0.3)
        assert newest.twist.twist.linear.x == pytest.approx(SPEED, rel=0.01)
        true = begun[0] + newest.pose.pose.position.x / SPEED * 1e9
        # Within what the fastest of the messages took, on a machine with other work.
        assert 0 <= from_stamp(newest.header.stamp) - true + 1e5 < 50e6
        check_correction(peer, moved, heard)
        peer.until(
            lambda: (fact := peer.facts.get('tracker: tracker')) and fact.level == HealthLevel.OK
        )
        offset = float(peer.facts['tracker: tracker'].values['clock_offset_s'])
        assert offset == pytest.approx(3600.0, abs=0.05)
    ended(process)
