"""Messages decoded by LTA are those that rclpy decodes: same classes, same types of fields."""

from array import array
from importlib import import_module
import random

from lta_config.topics import load_topic_table
from lta_graph.ros.message_decoder import build_decoder
from lta_graph.ros.message_validation import find_message_type, has_message_type
import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from rosidl_parser.definition import AbstractString, Array, BasicType, NamespacedType

TYPES = {
    kind.__name__: kind
    for row in load_topic_table().topics.values()
    if has_message_type(row)
    for kind in [find_message_type(row)]
}


def draw(kind, value, random):
    """Return a random value for a field that holds `value`."""
    if isinstance(kind, NamespacedType):
        return fill(type(value), random)
    if isinstance(kind, AbstractString):
        return ''.join(random.choices('aß,1', k=random.randrange(9)))
    if isinstance(kind, BasicType):
        if kind.typename in ('float', 'double'):
            return random.randrange(-999, 999) / 8
        return {'boolean': True, 'octet': b'\x05'}.get(kind.typename, random.randrange(100))
    if isinstance(kind, Array):
        return np.array([draw(kind.value_type, 0, random) for _ in value])
    if isinstance(value, array):
        return array(value.typecode, random.choices(range(99), k=random.randrange(5)))
    if isinstance(kind.value_type, AbstractString):
        return ['a', 'bcdef']
    part = getattr(import_module('.'.join(kind.value_type.namespaces)), kind.value_type.name)
    return [fill(part, random) for _ in range(random.randrange(3))]


def fill(kind, random):
    """Return a message with random fields."""
    message = kind()
    for name, slot in zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True):
        setattr(message, name, draw(slot, getattr(message, name), random))
    return message


def assert_alike(ours, theirs):
    """Compare values and their types, part by part."""
    assert type(ours) is type(theirs)
    if isinstance(theirs, list):
        assert len(ours) == len(theirs)
        for pair in zip(ours, theirs, strict=True):
            assert_alike(*pair)
    elif hasattr(theirs, 'get_fields_and_field_types'):
        assert ours._check_fields == theirs._check_fields
        for name in theirs.get_fields_and_field_types():
            assert_alike(getattr(ours, name), getattr(theirs, name))
    elif isinstance(theirs, np.ndarray):
        assert ours.dtype == theirs.dtype
        assert ours.tolist() == theirs.tolist()
    else:
        assert ours == theirs


@pytest.mark.parametrize('name', TYPES)
def test_a_message_is_decoded_as_by_rclpy(name):
    decode = build_decoder(TYPES[name])
    numbers = random.Random(name)
    for _ in range(20):
        data = serialize_message(fill(TYPES[name], numbers))
        assert_alike(decode(data), deserialize_message(data, TYPES[name]))


def test_what_is_no_plain_cdr_is_left_to_rclpy():
    kind = TYPES['Odometry']
    message = fill(kind, random.Random(1))
    data = serialize_message(message)
    with pytest.raises(Exception, match='deserialize'):
        build_decoder(kind)(data[:40])
    big = b'\0\0' + data[2:4] + (7).to_bytes(8, 'big')
    assert (
        build_decoder(TYPES['Float64'])(big).data
        == deserialize_message(big, TYPES['Float64']).data
    )
