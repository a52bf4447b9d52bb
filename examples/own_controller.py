"""
A controller in plain rclpy for GT-MAB: hold height and heading, and fly forward.

    ./lta run examples/own_controller.py --ros-args -r __ns:=/lta1
    ./lta launch fly controller:=false

docs/tutorials/your_node.md explains it.
"""

import math

from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState

ROTORS = ['up_left', 'up_right', 'forward_left', 'forward_right']  # as in the vehicle file
HOVER = 0.13  # duty of each upward rotor that carries the 2 g
UNKNOWN = -1.0  # in covariance[0]: the estimator still calibrates its biases


def yaw_of(q):
    return math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def clip(duty):
    return min(max(duty, 0.0), 1.0)  # the rotors do not reverse


class OwnController(Node):
    """Publish the duties for each estimate of the state."""

    def __init__(self):
        super().__init__('own_controller')
        self.declare_parameter('lockstep', False)
        lockstep = self.get_parameter('lockstep').value
        # In lockstep no message may be lost, whoever starts first
        durable = DurabilityPolicy.TRANSIENT_LOCAL if lockstep else DurabilityPolicy.VOLATILE
        qos = QoSProfile(depth=2000, durability=durable)
        self.motors = self.create_publisher(JointState, 'motors', qos)
        self.wanted, self.speed, self.begun = None, 0.0, False
        self.create_subscription(PoseStamped, 'setpoint/pose', self.on_pose, qos)
        self.create_subscription(TwistStamped, 'setpoint/velocity', self.on_velocity, qos)
        self.create_subscription(Odometry, 'odom', self.on_odom, qos)

    def on_pose(self, message):
        self.wanted = message.pose

    def on_velocity(self, message):
        self.speed = message.twist.linear.x

    def on_odom(self, message):
        self.begun = True
        command = JointState(name=ROTORS, effort=[0.0] * len(ROTORS))
        # The stamp says which state is answered; the simulator stops the motors without a fresh one
        command.header.stamp = message.header.stamp
        if self.wanted is not None and message.pose.covariance[0] != UNKNOWN:
            command.effort = self.compute_duties(message.pose.pose, message.twist.twist)
        self.motors.publish(command)

    def compute_duties(self, pose, twist):
        lift = HOVER + 0.8 * (self.wanted.position.z - pose.position.z) - 1.2 * twist.linear.z
        error = yaw_of(self.wanted.orientation) - yaw_of(pose.orientation)
        error = math.remainder(error, 2 * math.pi)
        turn = 0.5 * error - 1.2 * twist.angular.z
        # Turn first, then fly
        speed = self.speed * max(0.0, 1.0 - abs(error) / 0.5)
        forward = 0.6 * speed + 0.6 * (speed - twist.linear.x)
        return [clip(lift), clip(lift), clip(forward - turn), clip(forward + turn)]


def main():
    rclpy.init()
    node = OwnController()
    try:
        # Leave when the drone has gone
        while not node.begun or node.count_publishers('odom'):
            rclpy.spin_once(node, timeout_sec=0.5)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
