# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A navigator in plain rclpy: turn to the lamp and fly there, at a fixed height.

    ./lta run examples/own_navigator.py --ros-args -r __ns:=/lta1
    ./lta launch fly navigator:=false strategy:=bag

docs/tutorials/your_node.md explains it.
"""

from collections import deque
import math

from builtin_interfaces.msg import Time as Stamp
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TwistStamped
from nav_msgs.msg import Odometry
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time
from std_msgs.msg import Float64

BLOCK_NS = 100_000_000  # a light block is stamped with its first sample and ends this much later
ALTITUDE = 1.2  # m
SPEED = 0.4  # m/s
SEARCH = 0.6  # rad to turn at a time while no lamp is seen
UNKNOWN = 1e6  # m2 in covariance[0]: no lamp is seen


def to_ns(stamp: Stamp) -> int:
    """Return a stamp in nanoseconds."""
    return Time.from_msg(stamp).nanoseconds


class OwnNavigator(Node):
    """Publish a setpoint for each estimate of the lamp."""

    def __init__(self) -> None:
        super().__init__('own_navigator')
        self.declare_parameter('lockstep', False)
        lockstep = self.get_parameter('lockstep').value
        # In lockstep no message may be lost, whoever starts first
        durable = DurabilityPolicy.TRANSIENT_LOCAL if lockstep else DurabilityPolicy.VOLATILE
        qos = QoSProfile(depth=1000, durability=durable)
        self.pose = self.create_publisher(PoseStamped, 'setpoint/pose', qos)
        self.velocity = self.create_publisher(TwistStamped, 'setpoint/velocity', qos)
        self.beacon = self.create_publisher(Float64, 'light/beacon', qos)
        self.estimates: deque[PoseWithCovarianceStamped] = deque()
        self.odoms: deque[Odometry] = deque(maxlen=1000)
        self.create_subscription(
            PoseWithCovarianceStamped, 'light/estimate', self.on_estimate, qos
        )
        self.create_subscription(Odometry, 'odom', self.on_odom, qos)

    def on_estimate(self, message: PoseWithCovarianceStamped) -> None:
        """Take an estimate of the lamp."""
        self.estimates.append(message)
        self.answer()

    def on_odom(self, message: Odometry) -> None:
        """Take a state of the drone."""
        self.odoms.append(message)
        self.answer()

    def answer(self) -> None:
        """Answer each estimate by the state at the end of its block, whichever comes first."""
        while self.estimates:
            end_ns = to_ns(self.estimates[0].header.stamp) + BLOCK_NS
            state = next((m for m in self.odoms if to_ns(m.header.stamp) >= end_ns), None)
            if state is None:
                return
            self.publish_setpoint(self.estimates.popleft(), state)

    def publish_setpoint(self, estimate: PoseWithCovarianceStamped, state: Odometry) -> None:
        """Turn to the lamp, then fly to it."""
        q = state.pose.pose.orientation
        yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
        seen = estimate.pose.covariance[0] < UNKNOWN
        lamp = estimate.pose.pose.position
        turn = math.atan2(lamp.y, lamp.x) if seen else SEARCH
        pose, velocity = PoseStamped(), TwistStamped()
        # The stamp says which estimate is answered; in lockstep it must be the same
        pose.header.stamp = velocity.header.stamp = estimate.header.stamp
        pose.header.frame_id, velocity.header.frame_id = 'odom', 'base_link'
        pose.pose.position.z = ALTITUDE
        pose.pose.orientation.z = math.sin(0.5 * (yaw + turn))
        pose.pose.orientation.w = math.cos(0.5 * (yaw + turn))
        velocity.twist.linear.x = SPEED if seen and abs(turn) < 0.5 else 0.0
        self.pose.publish(pose)
        self.velocity.publish(velocity)
        self.beacon.publish(Float64(data=0.0))  # the demodulator's own frequency


def main() -> None:
    """Run the node until the drone has gone."""
    rclpy.init()
    node = OwnNavigator()
    begun = False
    try:
        while not begun or node.count_publishers('light/estimate'):
            rclpy.spin_once(node, timeout_sec=0.5)
            begun = begun or bool(node.odoms)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
