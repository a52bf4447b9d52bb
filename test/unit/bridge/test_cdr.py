"""Messages of rclpy in a bag: what rosbags writes is read by ROS, and written as it was by us."""

from diagnostic_msgs.msg import DiagnosticStatus
from lta_bridge.bag.schemas import encode_message
from lta_graph.ros.message_validation import decode_message
from lta_graph.ros.raw_subscriptions import load_message_class
import numpy as np
import pytest
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, Header


def test_every_type_survives_the_way_there_and_back(graph_type, random_message):
    rng = np.random.default_rng(4)
    for _ in range(5):
        _, data = random_message(graph_type, rng)
        message = decode_message(data, load_message_class(graph_type))
        whole = -(-len(data) // 4) * 4  # the middleware's writer fills the last word
        assert encode_message(message, graph_type) == data.ljust(whole, b'\0')


def test_what_is_cut_short_is_refused(graph_type, random_message):
    """The middleware's reader passes some that end within a sequence of sequences, later on."""
    _, data = random_message(graph_type, np.random.default_rng(5))
    kind = load_message_class(graph_type)
    for size in range(0, len(data) // 2, 7):
        with pytest.raises(ValueError, match=kind.__name__):
            decode_message(data[:size], kind)


def test_a_flag_by_hand():
    assert encode_message(Bool(data=True), 'std_msgs/msg/Bool').hex() == '0001000001000000'


def test_a_range_by_hand():
    """Stamp, 'r' with its zero, a byte, and 32-bit numbers at multiples of four."""
    message = Range(header=Header(frame_id='r'), radiation_type=1, range=2.0)
    message.header.stamp.sec, message.header.stamp.nanosec = 7, 250_000_000
    words = ['00010000', '07000000', '80b2e60e', '02000000', '7200', '01', '00']
    written = encode_message(message, 'sensor_msgs/msg/Range').hex()
    assert written == ''.join(words) + '00000000' * 3 + '00000040' + '00000000'


def test_padding_is_zero():
    """After the octet, and behind a text."""
    message = DiagnosticStatus(level=b'\1', name='ab', values=[])
    words = ['00010000', '01000000', '03000000', '61620000', '01000000', '00000000', '01000000']
    written = encode_message(message, 'diagnostic_msgs/msg/DiagnosticStatus').hex()
    assert written == ''.join(words) + '00000000' + '00000000'
