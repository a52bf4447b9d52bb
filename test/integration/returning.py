"""A process that returns a vector for each block and computes nothing: what DDS alone takes."""

from geometry_msgs.msg import Vector3Stamped
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image

BLOCK, VECTOR = 'returning/block', 'returning/vector'


def main() -> None:
    """Return vectors until Ctrl-C."""
    rclpy.init()
    node = rclpy.create_node('returning', namespace='/lta1')
    publisher = node.create_publisher(Vector3Stamped, VECTOR, 10)
    node.create_subscription(
        Image,
        BLOCK,
        lambda block: publisher.publish(Vector3Stamped(header=block.header)),
        qos_profile_sensor_data,
    )
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        return
