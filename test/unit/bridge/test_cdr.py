"""Messages of rclpy in a bag: read back by ROS and by rosbags, with zeros in the gaps."""

import math

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from lta_bridge.bag.schemas import load_jazzy_types
from lta_bridge.cdr import encode_message
from lta_config.topics import load_topic_table
from lta_graph.ros.message_validation import decode_message
from lta_graph.ros.raw_subscriptions import load_message_class
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from sensor_msgs.msg import BatteryState, Image, Imu, JointState, PointCloud2, PointField, Range
from std_msgs.msg import Bool, Header, Int16MultiArray


def header(frame='base_link'):
    message = Header(frame_id=frame)
    message.stamp.sec, message.stamp.nanosec = 7, 250_000_000
    return message


def odometry():
    message = Odometry(header=header(), child_frame_id='base')
    message.pose.covariance = np.arange(36.0)
    message.twist.twist.angular.z = math.pi
    return message


def energy():
    values = [KeyValue(key='power', value='1.5'), KeyValue(key='x', value='')]
    status = DiagnosticStatus(level=b'\2', name='energy', message='low', values=values)
    return DiagnosticArray(header=header(''), status=[status])


def cloud():
    fields = [PointField(name='x', offset=0, datatype=PointField.FLOAT32, count=1)]
    return PointCloud2(header=header(), height=1, width=1, fields=fields, data=b'\1\2\3\4')


MESSAGES = [
    Bool(data=True),
    Imu(header=header()),
    Range(header=header('r'), range=math.inf, min_range=0.25),
    odometry(),
    JointState(header=header(), name=['a', 'bcd'], effort=[0.25, -1.0]),
    BatteryState(
        header=header(), voltage=3.75, cell_voltage=[3.75], location='cell', present=True
    ),
    Image(header=header(), height=1, width=2, encoding='16UC1', data=b'\1\2\3\4'),
    energy(),
    cloud(),
    Int16MultiArray(data=[-1, 2]),
]
each_message = pytest.mark.parametrize('message', MESSAGES, ids=lambda m: type(m).__name__)


def name_type(message):
    kind = type(message)
    return f'{kind.__module__.split(".")[0]}/msg/{kind.__name__}'


def encode(message):
    return encode_message(message, name_type(message))


@each_message
def test_ros_reads_it_back(message):
    """By the middleware's own reader; NaN in it would compare unequal, so by their texts."""
    expected = str(message)
    assert str(decode_message(encode(message), type(message))) == expected


def test_a_flag_by_hand():
    assert encode(Bool(data=True)).hex() == '0001000001000000'


def test_a_range_by_hand():
    """Stamp, 'r' with its zero, a byte, and 32-bit numbers at multiples of four."""
    message = Range(header=header('r'), radiation_type=1, range=2.0)
    words = ['00010000', '07000000', '80b2e60e', '02000000', '7200', '01', '00']
    assert encode(message).hex() == ''.join(words) + '00000000' * 3 + '00000040' + '00000000'


def test_padding_is_zero():
    """After the octet, and behind a text."""
    message = DiagnosticStatus(level=b'\1', name='ab', values=[])
    words = ['00010000', '01000000', '03000000', '61620000', '01000000', '00000000', '01000000']
    assert encode(message).hex() == ''.join(words) + '00000000' + '00000000'


@each_message
def test_what_is_no_message_is_refused(message):
    data = encode(message)
    for size in range(0, len(data) - 4, 7):
        with pytest.raises(ValueError, match=type(message).__name__):
            decode_message(data[:size], type(message))


@pytest.mark.parametrize(
    'name', sorted({each.type for each in load_topic_table().topics.values()})
)
def test_every_type_of_the_topics_can_be_written_and_read(name):
    message = load_message_class(name)()
    expected = str(message)
    data = encode_message(message, name)
    assert str(decode_message(data, type(message))) == expected
    assert load_jazzy_types().deserialize_cdr(data, name)
