"""CDR as the middleware reads and writes it: aligned as the standard says, zeros in the gaps."""

import math
from struct import pack

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from lta_bridge.cdr import reencode_cdr
from lta_config.topics import load_topic_table
from lta_graph.cdr_encoder import encode_cdr
from lta_graph.ros.cdr_decoder import decode_cdr
from lta_graph.ros.raw_subscriptions import load_message_class
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.serde import SerdeError
from sensor_msgs.msg import BatteryState, Image, Imu, JointState, PointCloud2, PointField, Range
from std_msgs.msg import Bool, ByteMultiArray, Float64, Header, Int16MultiArray, String


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
    ByteMultiArray(data=[b'\1', b'\2']),
    Int16MultiArray(data=[-1, 2]),
]
each_message = pytest.mark.parametrize('message', MESSAGES, ids=lambda m: type(m).__name__)


def name_type(message):
    kind = type(message)
    return f'{kind.__module__.split(".")[0]}/msg/{kind.__name__}'


@each_message
def test_ros_reads_it_back(message):
    """By the middleware's own reader; NaN in it would compare unequal, so by their texts."""
    assert str(deserialize_message(encode_cdr(message), type(message))) == str(message)


def test_a_flag_by_hand():
    assert encode_cdr(Bool(data=True)).hex() == '0001000001000000'


def test_a_range_by_hand():
    """Stamp, 'r' with its zero, a byte, and 32-bit numbers at multiples of four."""
    message = Range(header=header('r'), radiation_type=1, range=2.0)
    words = ['00010000', '07000000', '80b2e60e', '02000000', '7200', '01', '00']
    assert encode_cdr(message).hex() == ''.join(words) + '00000000' * 3 + '00000040' + '00000000'


def list_types(value):
    """Return a message as nested lists of classes and values."""
    if hasattr(value, 'get_fields_and_field_types'):
        value = [getattr(value, name) for name in value.__slots__]
    nested = isinstance(value, list)
    return type(value), [list_types(part) for part in value] if nested else str(value)


@each_message
def test_decoded_it_is_what_ros_decodes(message):
    data = encode_cdr(message)
    expected = deserialize_message(data, type(message))
    assert list_types(decode_cdr(data, type(message))) == list_types(expected)


@each_message
def test_a_decoded_message_can_be_changed_and_sent(message):
    decoded = decode_cdr(encode_cdr(message), type(message))
    for name in decoded.get_fields_and_field_types():
        setattr(decoded, name, getattr(message, name))
    assert encode_cdr(decoded) == encode_cdr(message)
    assert serialize_message(decoded)


@each_message
def test_what_is_no_message_is_refused(message):
    data = encode_cdr(message)
    for size in range(len(data) - 4):
        with pytest.raises(ValueError, match=type(message).__name__):
            decode_cdr(data[:size], type(message))


def test_big_endian_data_are_decoded():
    assert decode_cdr(bytes.fromhex('00000000') + pack('>d', 0.25), Float64).data == 0.25


@pytest.mark.parametrize(
    ('text', 'decoded'), [(b'ab\0', 'ab'), (b'a\0b\0', 'a'), (b'a\xff\0', 'a\ufffd'), (b'', '')]
)
def test_texts_are_those_of_ros(text, decoded):
    data = bytes.fromhex('00010000') + pack('<I', len(text)) + text
    padded = data + bytes(-len(data) % 4)
    assert decode_cdr(padded, String).data == decoded
    if text:
        assert deserialize_message(padded, String).data == decoded


def test_a_sequence_beyond_the_data_is_refused():
    data = bytearray(encode_cdr(JointState(effort=[0.5])))
    data[-12] = 200  # its length
    with pytest.raises(ValueError, match='JointState'):
        decode_cdr(bytes(data), JointState)


@each_message
def test_reencoded_it_is_the_same(message):
    data = encode_cdr(message)
    assert len(data) % 4 == 0
    assert reencode_cdr(data, name_type(message)) == data


@pytest.mark.parametrize(
    'name', sorted({each.type for each in load_topic_table().topics.values()})
)
def test_every_type_of_the_topics_can_be_written_and_read(name):
    message = load_message_class(name)()
    data = encode_cdr(message)
    expected = deserialize_message(data, type(message))
    assert str(expected) == str(message)
    assert list_types(decode_cdr(data, type(message))) == list_types(expected)
    assert reencode_cdr(data, name) == data


def test_padding_becomes_zero():
    """After the octet, and at the end."""
    message = DiagnosticStatus(level=b'\1', name='ab', values=[])
    data = encode_cdr(message)
    words = ['00010000', '01000000', '03000000', '61620000', '01000000', '00000000', '01000000']
    assert data.hex() == ''.join(words) + '00000000' + '00000000'
    dirty = bytearray(data)
    dirty[5:8] = b'\xff\xff\xff'  # between the octet and the length of the name
    dirty[15] = dirty[21] = 0xFF  # behind the two strings
    assert reencode_cdr(bytes(dirty), 'diagnostic_msgs/msg/DiagnosticStatus') == data


@pytest.mark.parametrize('size', [0, 3, 40, 92])
def test_data_cut_short_are_refused(size):
    with pytest.raises(SerdeError):
        reencode_cdr(encode_cdr(energy())[:size], 'diagnostic_msgs/msg/DiagnosticArray')
