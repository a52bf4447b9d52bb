# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Bags of ROS 2 and ROS 1: taken as they are, renamed, or turned into our topics."""

from pathlib import Path

from lta_analysis.import_draft import list_missing_parts
from lta_bag.reader import read_bag
from lta_config.errors import BadInput
from lta_data.importers.draft.draft_mapping import draft_mapping
from lta_data.importers.run import import_logs, ImportRequest
from mcap.reader import make_reader
from mcap.writer import Writer as McapWriter
import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import get_types_from_msg, get_typestore, Stores
import yaml

BAG = 'schema: 1\nname: mine\nabout: a test\nformat: bag\n'
POSE = 'geometry_msgs/msg/PoseStamped'
SECOND = 1_000_000_000
CUSTOM = 'my_msgs/msg/Thrust'


def store(which=Stores.ROS2_JAZZY):
    """Return the types of a ROS, and one that is in none."""
    types = get_typestore(which)
    types.register(get_types_from_msg('std_msgs/Header header\nfloat32[] newtons', CUSTOM))
    return types


def header(types, nanoseconds, frame='vicon'):
    time = types.types['builtin_interfaces/msg/Time'](*divmod(nanoseconds, SECOND))
    kind = types.types['std_msgs/msg/Header']
    return kind(seq=7, stamp=time, frame_id=frame) if 'seq' in fields(types) else kind(time, frame)


def fields(types):
    return [name for name, _ in types.fielddefs['std_msgs/msg/Header'][1]]


def pose(types, x, y, z, q=(0.0, 0.0, 0.0, 1.0)):
    kind = types.types
    place = kind['geometry_msgs/msg/Point'](x, y, z)
    return kind['geometry_msgs/msg/Pose'](place, kind['geometry_msgs/msg/Quaternion'](*q))


def flight(types):
    """Return (topic, type, log time, message) of a short recording."""
    kind = types.types
    found = []
    for k in range(5):
        stamp = 10 * SECOND + k * 10_000_000
        found += [
            (
                '/vicon/drone',
                POSE,
                stamp + 3_000,
                kind[POSE](header(types, stamp), pose(types, k, 2.0, -1.0)),
            ),
            (
                '/thrust',
                CUSTOM,
                stamp + 4_000,
                kind[CUSTOM](header(types, stamp), np.array([k, 2], np.float32)),
            ),
        ]
    return found  # fmt: skip


def write2(path, plugin, messages, types):
    with Writer2(path, version=9, storage_plugin=plugin) as writer:
        open_ = {}
        for topic, kind, time, message in messages:
            if topic not in open_:
                open_[topic] = writer.add_connection(topic, kind, typestore=types)
            writer.write(open_[topic], time, types.serialize_cdr(message, kind))
    return path


def write1(path, messages, types):
    with Writer1(path) as writer:
        open_ = {}
        for topic, kind, time, message in messages:
            if topic not in open_:
                open_[topic] = writer.add_connection(topic, kind, typestore=types)
            writer.write(open_[topic], time, types.serialize_ros1(message, kind))
    return path


def raw(path):
    return [(topic, time, bytes(data)) for topic, time, data in read_bag(path).iterate_messages()]


@pytest.mark.parametrize('plugin', [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_a_bag_of_ros_2_is_taken_as_it_is_byte_by_byte(bring, tmp_path, plugin):
    types = store()
    messages = flight(types)
    source = write2(tmp_path / 'bag', plugin, messages, types)
    found = bring(source)
    expected = [(t, time, bytes(types.serialize_cdr(m, kind))) for t, kind, time, m in messages]
    assert raw(found.imported.bag) == expected
    assert found.types == {'/vicon/drone': POSE, '/thrust': CUSTOM}
    assert found.messages['/thrust'][3].newtons.tolist() == [3.0, 2.0]
    assert found.imported.topics == {'/thrust': 5, '/vicon/drone': 5}


@pytest.mark.parametrize('ros', [1, 2])
def test_a_trackers_pose_becomes_our_truth_in_our_axes(bring, tmp_path, ros):
    types = store(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_JAZZY)
    messages = flight(types)
    if ros == 1:
        source = write1(tmp_path / 'flight.bag', messages, types)
    else:
        source = write2(tmp_path / 'bag', StoragePlugin.SQLITE3, messages, types)
    mapping = BAG + (
        'world: NED\nbody: FRD\ntopics:\n  - {topic: ground_truth/odom, table: /vicon/drone}\n'
    )
    found = bring(source, mapping)
    truth = found.messages['/lta1/ground_truth/odom']
    places = [message.pose.pose.position for message in truth]
    assert [(p.x, p.y, p.z) for p in places] == [(2.0, k, 1.0) for k in range(5)]
    assert all(message.twist.covariance[0] == -1.0 for message in truth)
    stamps = [10 * SECOND + k * 10_000_000 for k in range(5)]
    assert found.stamps('/lta1/ground_truth/odom') == stamps
    assert found.times['/lta1/ground_truth/odom'] == [stamp + 3_000 for stamp in stamps]
    assert found.order == ['/lta1/ground_truth/odom', '/thrust'] * 5
    assert '/vicon/drone' not in found.messages
    assert found.messages['/thrust'][4].newtons.tolist() == [4.0, 2.0]
    assert found.stamps('/thrust') == stamps


def test_a_topic_of_our_type_is_only_renamed(bring, tmp_path):
    types = store()
    kind = types.types
    cells = np.arange(9.0)
    vector = kind['geometry_msgs/msg/Vector3'](1.0, 2.0, 3.0)
    quaternion = kind['geometry_msgs/msg/Quaternion'](0.0, 0.0, 0.0, 1.0)
    imu = kind['sensor_msgs/msg/Imu'](
        header(types, SECOND, 'chip'), quaternion, cells, vector, cells, vector, cells
    )
    name = 'sensor_msgs/msg/Imu'
    source = write2(tmp_path / 'bag', StoragePlugin.MCAP, [('/chip', name, SECOND, imu)], types)
    found = bring(source, BAG + 'topics:\n  - {topic: imu, table: /chip}\n')
    assert raw(found.imported.bag) == [
        ('/lta1/imu', SECOND, bytes(types.serialize_cdr(imu, name)))
    ]


def test_types_that_ros_2_has_changed_are_moved_field_by_field(bring, tmp_path):
    """Range has got a variance since ROS 1; a sequence number is nowhere any more."""
    types = store(Stores.ROS1_NOETIC)
    name = 'sensor_msgs/msg/Range'
    message = types.types[name](header(types, 5 * SECOND + 7, 'tof'), 1, 0.5, 0.04, 4.0, 1.25)
    source = write1(tmp_path / 'a.bag', [('/tof', name, 5 * SECOND, message)], types)
    (found,) = bring(source).messages['/tof']
    assert (found.range, found.max_range, found.variance) == (1.25, 4.0, 0.0)
    assert (found.header.stamp.sec, found.header.stamp.nanosec) == (5, 7)
    assert found.header.frame_id == 'tof'


def test_one_child_of_the_transforms_is_taken(bring, tmp_path):
    types = store()
    kind = types.types
    transforms = []
    for child, x in (('drone', 1.0), ('wand', 5.0)):
        body = kind['geometry_msgs/msg/Transform'](
            kind['geometry_msgs/msg/Vector3'](x, 2.0, 3.0),
            kind['geometry_msgs/msg/Quaternion'](0.0, 0.0, 0.6, 0.8),
        )
        transforms.append(
            kind['geometry_msgs/msg/TransformStamped'](header(types, 4 * SECOND), child, body)
        )
    name = 'tf2_msgs/msg/TFMessage'
    message = kind[name](transforms)
    source = write2(tmp_path / 'bag', StoragePlugin.MCAP, [('/tf', name, SECOND, message)], types)
    found = bring(source, BAG + 'topics:\n  - {topic: ground_truth/odom, table: "/tf#drone"}\n')
    (truth,) = found.messages['/lta1/ground_truth/odom']
    assert truth.pose.pose.position.x == 1.0
    assert truth.pose.pose.orientation.z == 0.6
    assert len(found.messages['/tf']) == 1


@pytest.mark.parametrize('piece', [2, 10_000])
def test_fields_of_any_type_are_columns(bring, tmp_path, monkeypatch, piece):
    monkeypatch.setattr('lta_data.importers.readers.bag_tables.MESSAGES_PER_PIECE', piece)
    types = store()
    source = write2(tmp_path / 'bag', StoragePlugin.MCAP, flight(types), types)
    mapping = BAG + (
        'topics:\n'
        '  - topic: motors\n'
        '    table: /thrust\n'
        '    actuators:\n'
        '      left: {effort: {column: "newtons[0]", unit: mN}}\n'
        '      right: {effort: {column: "newtons[1]", unit: mN}}\n'
    )
    found = bring(source, mapping)
    efforts = [message.effort.tolist() for message in found.messages['/lta1/motors']]
    assert efforts == [[k * 1e-3, 2e-3] for k in range(5)]


def test_a_bag_that_was_cut_short_is_imported_as_far_as_it_goes(bring, tmp_path):
    types = store()
    folder = write2(tmp_path / 'bag', StoragePlugin.MCAP, flight(types), types)
    (file,) = folder.glob('*.mcap')
    source = tmp_path / 'cut.mcap'
    source.write_bytes(file.read_bytes()[:-300])
    found = bring(source)
    assert len(found.messages['/vicon/drone']) == 5
    assert 'The recording was not finished' in found.notes


WRONG = {
    'no such topic': (
        '  - {topic: ground_truth/odom, table: /nothing}\n',
        "lacks the table '/nothing'",
    ),
    'no such child': (
        '  - {topic: ground_truth/odom, table: "/tf#me"}\n',
        "lacks the table '/tf#me'",
    ),
    'nothing known': ('  - {topic: battery, table: /vicon/drone}\n', 'has no standard conversion'),
    'no such field': (
        '  - {topic: range, table: /thrust, range: {column: "newtons[5]", unit: m}}\n',
        "has no column 'newtons[5]'; it has header.stamp.sec",
    ),
}


@pytest.mark.parametrize(('entry', 'sentence'), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_one_sentence(bring, tmp_path, entry, sentence):
    types = store()
    source = write2(tmp_path / 'bag', StoragePlugin.MCAP, flight(types), types)
    with pytest.raises(BadInput) as told:
        bring(source, BAG + 'topics:\n' + entry)
    assert sentence in str(told.value)
    assert not (tmp_path / 'out').exists()


@pytest.mark.parametrize('name', ['broken.bag', 'broken.db3'])
def test_a_broken_bag_is_one_sentence(bring, tmp_path, name):
    heads = {'broken.bag': b'#ROSBAG V2.0\n', 'broken.db3': b'SQLite format 3\0'}
    (tmp_path / name).write_bytes(heads[name] + bytes(range(256)) * 4)
    with pytest.raises(BadInput, match=r"'[^']*broken\.\w+' cannot be read"):
        bring(tmp_path / name)


def test_what_is_not_of_ros_is_kept_with_its_encoding_and_definition(tmp_path):
    source = tmp_path / 'other.mcap'
    with source.open('wb') as stream:
        writer = McapWriter(stream)
        writer.start()
        schema = writer.register_schema('my.State', 'jsonschema', b'{"type": "object"}')
        channel = writer.register_channel('/state', 'json', schema)
        writer.add_message(channel, SECOND, b'{"x": 1}', SECOND)
        writer.finish()
    (done,) = import_logs(ImportRequest([source]), tmp_path / 'out')
    found = next(Path(done.bag).glob('*.mcap'))
    with found.open('rb') as stream:
        ((schema, channel, message),) = make_reader(stream).iter_messages()
    assert (schema.encoding, schema.data) == ('jsonschema', b'{"type": "object"}')
    assert (channel.message_encoding, message.data) == ('json', b'{"x": 1}')
    assert message.log_time == SECOND


def test_an_array_that_is_named_after_actuators_is_drafted_as_commands(tmp_path):
    types = store()
    array, layout = 'std_msgs/msg/Int32MultiArray', types.types['std_msgs/msg/MultiArrayLayout']
    pulses = np.array([[1500, 1500], [1500, 1300]], np.int32)
    messages = [
        (topic, array, 10 * SECOND + k * SECOND // 20, types.types[array](layout([], 0), row))
        for k, row in enumerate(np.tile(pulses, (20, 1)))
        for topic in ('/notes', '/radio/esc_us')
    ]
    source = write2(tmp_path / 'bag', StoragePlugin.MCAP, [*flight(types), *messages], types)
    draft = draft_mapping(source, {})
    (motors,) = [one for one in yaml.safe_load(draft.text)['topics'] if one['topic'] == 'motors']
    assert motors['table'] == '/radio/esc_us'
    assert [*motors['actuators'].values()] == [
        {'effort': {'column': f'data[{k}]', 'offset': -1500, 'over': 500}} for k in (0, 1)
    ]
    # The topic of the pose has position and attitude by its type
    assert list_missing_parts(draft.text) == []
