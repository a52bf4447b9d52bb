"""The tracker node in a graph: poses of a clock an hour ahead come out as the truth of now."""

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from lta_graph.ros.node import from_stamp, to_stamp
import pytest
from rclpy.qos import qos_profile_sensor_data

from .peer import Peer, start

AHEAD = 3600 * 10**9
SPEED = 0.5


def test_a_tracker_tells_the_truth_by_our_clock(domain_id):
    process = start('lta_bridge.nodes.tracker', '-p', 'body:=[0.0, 0.0, 0.3, 0.0]')
    with Peer(domain_id) as peer:
        heard, facts, begun = [], {}, []

        def told(array: DiagnosticArray):
            facts.update({status.name: status for status in array.status})

        peer.hear('ground_truth/odom', heard.append)
        peer.hear('/diagnostics', told)
        poses = peer.offering('tracker/pose', PoseStamped, qos_profile_sensor_data)
        clock = peer.node.get_clock()

        def say():
            now = clock.now().nanoseconds
            begun.append(now)
            message = PoseStamped()
            message.header.stamp = to_stamp(now + AHEAD)
            message.pose.position.x = 1e-9 * SPEED * (now - begun[0])
            message.pose.orientation.w = 1.0
            poses.publish(message)

        peer.node.create_timer(0.01, say)
        peer.until(lambda: len(heard) > 60)
        newest = heard[-1]
        assert newest.header.frame_id == 'map'
        assert newest.pose.pose.position.z == pytest.approx(0.3)
        assert newest.twist.twist.linear.x == pytest.approx(SPEED, rel=0.01)
        true = begun[0] + newest.pose.pose.position.x / SPEED * 1e9
        # Within what the fastest of the messages took, on a machine with other work.
        assert 0 <= from_stamp(newest.header.stamp) - true + 1e5 < 50e6
        peer.until(
            lambda: facts.get('tracker: tracker') and facts['tracker: tracker'].level == b'\0'
        )
        values = {item.key: item.value for item in facts['tracker: tracker'].values}
        assert float(values['clock_offset_s']) == pytest.approx(3600.0, abs=0.05)
    process.terminate()
    process.communicate(timeout=20.0)
    assert process.returncode == 0
