# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whole topics at a time give what object by object gives, for any message of any type."""

from functools import cache

from hypothesis import example, given, settings
from hypothesis import strategies as st
from lta_bag.mcap_file.decoder import MessageDecoder
from lta_bag.schemas import generate_definition, load_jazzy_types
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_data.bag import column_builder
from lta_data.bag.cdr_layout import derive_layout, LayoutMismatch
from lta_data.bag.column_builder import ColumnBuilder, MessageType
from lta_data.bag.columns import extract_field_columns, extract_stamp
from mcap.records import Schema
import numpy as np
import pytest
from rosbags.interfaces import Nodetype

OURS = sorted({topic.type for topic in load_topic_table().topics.values()})
OTHERS = [
    'geometry_msgs/msg/PolygonStamped',
    'geometry_msgs/msg/TransformStamped',
    'geometry_msgs/msg/WrenchStamped',
    'nav_msgs/msg/Path',
    'rcl_interfaces/msg/Log',
    'sensor_msgs/msg/CameraInfo',
    'sensor_msgs/msg/Joy',
    'sensor_msgs/msg/LaserScan',
    'sensor_msgs/msg/NavSatFix',
    'std_msgs/msg/ByteMultiArray',
    'std_msgs/msg/Empty',
    'std_msgs/msg/Float64MultiArray',
    'std_msgs/msg/Int64',
    'std_msgs/msg/String',
    'std_msgs/msg/UInt64',
    'std_msgs/msg/UInt64MultiArray',
    'tf2_msgs/msg/TFMessage',
    'trajectory_msgs/msg/JointTrajectory',
]
NARROW, WIDE = 'abcxyz_/ 0123\0', 'é°'  # letters of one byte, and of two
FLOATS = [0.0, -0.0, 1.5, -2e300, np.nan, np.inf, 1e-320]


def drawn(type_name, shape, values):
    """Return a message: its lengths are drawn from one generator, its values from the other."""
    return load_jazzy_types().types[type_name](
        *(
            part(described, shape, values)
            for _, described in load_jazzy_types().fielddefs[type_name][1]
        )
    )


def part(described, shape, values):
    kind, detail = described
    if kind is Nodetype.NAME:
        return drawn(detail, shape, values)
    if kind is Nodetype.BASE:
        return single(detail[0], shape, values)
    item, count = detail
    count = int(shape.integers(0, 4)) if kind is Nodetype.SEQUENCE else count
    if item[0] is Nodetype.BASE and item[1][0] != 'string':
        return np.array(
            [single(item[1][0], shape, values) for _ in range(count)],
            {'bool': 'bool', 'byte': 'int8', 'char': 'uint8'}.get(item[1][0], item[1][0]),
        )
    return [part(item, shape, values) for _ in range(count)]


def single(name, shape, values):
    if name == 'string':
        widths = shape.integers(0, 4, shape.integers(0, 5))
        sets = [NARROW if width else WIDE for width in widths]
        return ''.join(letters[values.integers(len(letters))] for letters in sets)
    if name == 'bool':
        return bool(values.integers(2))
    if name.startswith('float'):
        value = FLOATS[values.integers(len(FLOATS))] if values.integers(2) else values.normal()
        return (
            float(np.float32(np.clip(value, -1e30, 1e30))) if name == 'float32' else float(value)
        )
    kind = np.dtype({'byte': 'int8', 'char': 'uint8'}.get(name, name))
    limit = np.iinfo(kind)
    return int(values.integers(limit.min, limit.max, dtype=kind, endpoint=True))


@cache
def typed(type_name):
    """Return a type and how to read it, by the definition that a bag would bring."""
    found = generate_definition(type_name)
    decoder = MessageDecoder({type_name: Schema(1, found.text.encode(), 'ros2msg', type_name)})
    return MessageType(
        type_name, decoder.list_fields, lambda data: decoder.decode(type_name, data)
    )


def gathered(kind, messages):
    maker = ColumnBuilder(kind)
    for index, data in enumerate(messages):
        maker.add_message(index, data)
    return maker.flush_columns()


def same(found, expected):
    assert list(found) == list(expected)
    for path, values in expected.items():
        # numpy drops NUL at the end of a text, but may keep its room
        kinds = {found[path].dtype.kind, values.dtype.kind}
        assert found[path].dtype == values.dtype or kinds == {'U'}, path
        np.testing.assert_array_equal(found[path], values, path)


def check(type_name, messages):
    kind = typed(type_name)
    objects = [kind.decode(data) for data in messages]
    numbers, texts = extract_field_columns(objects)
    found = gathered(kind, messages)
    same(found.numbers, numbers)
    same(found.texts, texts)
    assert found.stamps.tolist() == [extract_stamp(message) or 0 for message in objects]
    assert found.logged == list(range(len(messages)))


@pytest.mark.parametrize('type_name', OURS + OTHERS)
@settings(max_examples=8)
@example(turns=[], shapes=[0], seed=0, batch=4)
@example(turns=[(0, False), (0, False)], shapes=[0] * 4, seed=0, batch=1)
@given(
    turns=st.lists(st.tuples(st.integers(0, 3), st.booleans()), max_size=12),
    shapes=st.lists(st.integers(0, 2**31), min_size=4, max_size=4),
    seed=st.integers(0, 2**31),
    batch=st.integers(1, 8),
)
def test_whole_topics_give_what_single_messages_give(type_name, turns, shapes, seed, batch):
    values = np.random.default_rng(seed)
    messages = []
    for which, little in turns:
        message = drawn(type_name, np.random.default_rng(shapes[which % len(shapes)]), values)
        data = bytes(load_jazzy_types().serialize_cdr(message, type_name, little_endian=little))
        # Writers fill the end of a message to a multiple of four, or do not.
        messages.append(data + bytes(-len(data) % 4 if values.integers(2) else 0))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(column_builder, 'BATCH_MESSAGES', batch)
        check(type_name, messages)


@pytest.mark.parametrize(
    ('change', 'at'), [(b'\xff', 12), (b'\x09', 16 + 3), (b'\xff', 16), (b'\x02', 1), (b'', -2)]
)
def test_what_does_not_fit_is_refused_as_an_object_is(change, at):
    kind = 'sensor_msgs/msg/Range'
    message = drawn(kind, np.random.default_rng(3), np.random.default_rng(3))
    message.header.frame_id = 'ray'
    good = bytes(load_jazzy_types().serialize_cdr(message, kind))
    bad = good[:at] + change + good[at + 1 :] if change else good[:at]
    with pytest.raises(BadInput, match='does not match the definition'):
        typed(kind).decode(bad)
    for messages in ([bad], [good, bad], [good] * 5 + [bad] * 5):
        with pytest.raises(BadInput, match='does not match the definition'):
            gathered(typed(kind), messages)


@given(data=st.binary(max_size=60), type_name=st.sampled_from(OURS + OTHERS))
@settings(max_examples=150)
def test_any_bytes_have_a_layout_only_where_they_are_a_message(data, type_name):
    kind = typed(type_name)
    data = b'\x00\x01\x00\x00' + data
    try:
        derive_layout(type_name, data, kind.fields)
    except LayoutMismatch:
        return
    kind.decode(data)
