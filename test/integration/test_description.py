"""The description node in a graph: its URDF reaches who comes late."""

from xml.etree import ElementTree

from rcl_interfaces.srv import ListParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from waiting import PATIENCE

from .peer import Peer, start


def test_a_viewer_that_comes_late_gets_the_urdf(domain_id):
    process = start('lta_bridge.nodes.description', '-p', 'vehicle:=gtmab')
    with Peer(domain_id) as peer:
        heard = []
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        peer.node.create_subscription(String, 'robot_description', heard.append, latched)
        peer.until(lambda: heard)
        assert ElementTree.fromstring(heard[0].data).get('name') == 'gtmab'
        # The URDF comes while the node is made; who answers a service works, and leaves in order.
        peer.ask(ListParameters, 'description/list_parameters')
    process.terminate()
    process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
