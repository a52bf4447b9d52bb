# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A controller in plain rclpy for GT-MAB: hold height and heading, and fly forward.

    ./lta run examples/own_controller.py --ros-args -r __ns:=/lta1
    ./lta launch fly controller:=false

docs/tutorials/your_node.md explains it.
"""

import math

from geometry_msgs.msg import Pose, PoseStamped, Quaternion, Twist, TwistStamped
from lta_msgs.msg import ActuatorDuty
from nav_msgs.msg import Odometry
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time

ROTORS = ['up_left', 'up_right', 'forward_left', 'forward_right']  # as in the vehicle file
HOVER = 0.13  # duty of each upward rotor that carries the 2 g
STALE_NS = 1_000_000_000  # without a newer setpoint the motors stop
UNKNOWN = 1e6  # m2 in covariance[0]: the estimator still calibrates its biases


def yaw_of(q: Quaternion) -> float:
    """Return the heading [rad]."""
    return math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def clip(value: float, limit: float) -> float:
    """Return a value within plus and minus a limit."""
    return min(max(value, -limit), limit)


def to_duty(value: float) -> float:
    """Return a value as a duty."""
    return min(max(value, 0.0), 1.0)  # the rotors do not reverse


def compute_duties(wanted: Pose, wanted_speed: float, pose: Pose, twist: Twist) -> list[float]:
    """Return the duty of each rotor, in the order of ROTORS."""
    lift = HOVER + 0.8 * (wanted.position.z - pose.position.z) - 1.2 * twist.linear.z
    off = yaw_of(pose.orientation) - yaw_of(wanted.orientation)
    # A round hull has no keel: point the nose into the drift across the course
    drift = math.sin(off) * twist.linear.x + math.cos(off) * twist.linear.y
    error = math.remainder(-off - clip(2.0 * drift, 0.8), 2 * math.pi)
    turn = 0.5 * error - 1.2 * twist.angular.z
    # Turn first, then fly
    speed = wanted_speed * max(0.0, 1.0 - abs(error) / 0.9)
    forward = 0.6 * speed + 0.6 * (speed - twist.linear.x)
    return [to_duty(each) for each in (lift, lift, forward - turn, forward + turn)]


class OwnController(Node):
    """Publish the duties for each estimate of the state."""

    def __init__(self) -> None:
        super().__init__('own_controller')
        self.declare_parameter('lockstep', False)
        lockstep = self.get_parameter('lockstep').value
        # In lockstep no message may be lost, whoever starts first
        durable = DurabilityPolicy.TRANSIENT_LOCAL if lockstep else DurabilityPolicy.VOLATILE
        qos = QoSProfile(depth=2000, durability=durable)
        self.motors = self.create_publisher(ActuatorDuty, 'motors', qos)
        self.wanted: PoseStamped | None = None
        self.speed, self.begun = 0.0, False
        self.create_subscription(PoseStamped, 'setpoint/pose', self.on_pose, qos)
        self.create_subscription(TwistStamped, 'setpoint/velocity', self.on_velocity, qos)
        self.create_subscription(Odometry, 'odom', self.on_odom, qos)

    def on_pose(self, message: PoseStamped) -> None:
        """Take the height and heading to hold."""
        self.wanted = message

    def on_velocity(self, message: TwistStamped) -> None:
        """Take the airspeed to hold."""
        self.speed = message.twist.linear.x

    def on_odom(self, message: Odometry) -> None:
        """Answer a state with duties."""
        self.begun = True
        command = ActuatorDuty(name=ROTORS, duty=[0.0] * len(ROTORS))
        # The stamp says which state is answered; without a fresh one the motors stop
        command.header.stamp = message.header.stamp
        known = message.pose.covariance[0] < UNKNOWN
        if known and self.wanted is not None and not self.is_stale(message):
            command.duty = compute_duties(
                self.wanted.pose, self.speed, message.pose.pose, message.twist.twist
            )
        self.motors.publish(command)

    def is_stale(self, message: Odometry) -> bool:
        """Return whether the navigator has fallen silent."""
        age = Time.from_msg(message.header.stamp) - Time.from_msg(self.wanted.header.stamp)
        return age.nanoseconds > STALE_NS


def main() -> None:
    """Run the node until the drone has gone."""
    rclpy.init()
    node = OwnController()
    try:
        while not node.begun or node.count_publishers('odom'):
            rclpy.spin_once(node, timeout_sec=0.5)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
