# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Bags and messages there and back, by libraries of others."""

import struct
import zlib

from lta_bag import BagWriter, build_offered_qos
from lta_bag.schemas import encode_message, generate_definition
from lta_graph.ros.message_validation import decode_message
from lta_graph.ros.raw_subscriptions import load_message_class
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import get_typestore, Stores
import yaml

FOREVER = QosTime(9223372036, 854775807)


def equal(left, right):
    if isinstance(left, np.ndarray):
        return left.dtype == right.dtype and np.array_equal(left, right)
    if isinstance(left, list):
        return len(left) == len(right) and all(map(equal, left, right))
    if hasattr(left, '__dataclass_fields__'):
        return all(equal(getattr(left, n), getattr(right, n)) for n in left.__dataclass_fields__)
    return left == right


def test_rosbags_reads_every_type_by_the_bag_alone(tmp_path, graph_type, random_message):
    rng = np.random.default_rng(4)
    sent = [random_message(graph_type, rng) for _ in range(20)]
    with BagWriter(tmp_path / 'bag', {'seed': '4'}) as bag:
        bag.add_topic('/lta1/topic', graph_type, [build_offered_qos('reliable', 'volatile', 10)])
        for i, (_, data) in enumerate(sent):
            bag.write('/lta1/topic', data, 1_000_000_000 + i)
            if i == 11:
                bag.flush()
    # A default of an empty store: only the definition inside the bag can decode.
    with AnyReader([tmp_path / 'bag'], default_typestore=get_typestore(Stores.EMPTY)) as reader:
        got = list(reader.messages())
        assert [time for _, time, _ in got] == [1_000_000_000 + i for i in range(20)]
        assert [data for _, _, data in got] == [data for _, data in sent]
        for (connection, _, data), (message, _) in zip(got, sent, strict=True):
            assert connection.msgtype == graph_type
            assert equal(message, reader.deserialize(data, connection.msgtype))


def test_mcap_library_reads_profile_encodings_and_checksums(tmp_path, random_message):
    rng = np.random.default_rng(5)
    message, data = random_message('nav_msgs/msg/Odometry', rng)
    with BagWriter(tmp_path / 'bag', {'commit': 'abc'}) as bag:
        bag.add_topic('/lta1/odom', 'nav_msgs/msg/Odometry', [])
        for i in range(3):
            bag.write('/lta1/odom', data, 7 + i)
            bag.flush()
    with (tmp_path / 'bag' / 'bag_0.mcap').open('rb') as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == 'ros2'
        summary = reader.get_summary()
        assert summary.statistics.message_count == 3
        assert summary.statistics.chunk_count == len(summary.chunk_indexes) == 3
        assert summary.schemas[1].encoding == 'ros2msg'
        assert '=' * 80 + '\nMSG: geometry_msgs/Pose' in summary.schemas[1].data.decode()
        assert summary.channels[1].message_encoding == 'cdr'
        assert {index.compression for index in summary.chunk_indexes} == {'zstd'}
        assert [m.metadata for m in reader.iter_metadata()] == [{'commit': 'abc'}]
        decoded = [found for *_, found in reader.iter_decoded_messages()]
        stream.seek(0)
        data = stream.read()
        start, _, crc = struct.unpack('<QQI', data[-28:-8])
        assert crc == zlib.crc32(data[start:-12])
        assert [found.pose.pose.position.x for found in decoded] == [
            message.pose.pose.position.x
        ] * 3


def test_topics_are_read_one_by_one_through_the_message_indexes(tmp_path):
    with BagWriter(tmp_path / 'bag', {}) as bag:
        for name in ('/a', '/b'):
            bag.add_topic(name, 'std_msgs/msg/Bool', [])
        for i in range(30):
            bag.write('/a' if i % 3 else '/b', bytes([0, 1, 0, 0, i]), i)
            if i % 7 == 0:
                bag.flush()
    with Reader(tmp_path / 'bag') as reader:
        wanted = [c for c in reader.connections if c.topic == '/b']
        assert [time for _, time, _ in reader.messages(wanted)] == list(range(0, 30, 3))
        assert {c.topic: c.msgcount for c in reader.connections} == {'/a': 20, '/b': 10}
    with (tmp_path / 'bag' / 'bag_0.mcap').open('rb') as stream:
        found = make_reader(stream).iter_messages(topics='/b', starting_at=6, ending_before=16)
        assert [message.log_time for *_, message in found] == [6, 9, 12, 15]


@pytest.mark.parametrize('provenance', [{}, {'seed': '7', 'note': 'two\nlines: {"json": 1}'}])
def test_metadata_is_what_rosbags_writes(tmp_path, provenance):
    profile = Qos(
        QosHistory.KEEP_LAST, 10, QosReliability.BEST_EFFORT, QosDurability.TRANSIENT_LOCAL,
        FOREVER, FOREVER, QosLiveliness.AUTOMATIC, FOREVER, False,
    )  # fmt: skip
    types = get_typestore(Stores.ROS2_JAZZY)
    theirs = Writer(tmp_path / 'theirs', version=9, storage_plugin=StoragePlugin.MCAP)
    for key, value in provenance.items():
        theirs.set_custom_data(key, value)
    with theirs, BagWriter(tmp_path / 'ours', provenance) as ours:
        for name, kind in {
            '/x/imu': 'sensor_msgs/msg/Imu',
            '/tf': 'tf2_msgs/msg/TFMessage',
        }.items():
            link = theirs.add_connection(
                name, kind, typestore=types, offered_qos_profiles=[profile]
            )
            ours.add_topic(name, kind, [build_offered_qos('best_effort', 'transient_local', 10)])
            for i in range(5):
                theirs.write(link, 100 + i, b'\0\1\0\0')
                ours.write(name, b'\0\1\0\0', 100 + i)
    texts = [(tmp_path / name / 'metadata.yaml').read_text('utf-8') for name in ('theirs', 'ours')]
    expected, found = (yaml.safe_load(text)['rosbag2_bagfile_information'] for text in texts)
    # rosbags names the file and the distribution its own way; ros2 bag writes <folder>_0.mcap.
    expected |= {'ros_distro': 'jazzy', 'relative_file_paths': ['ours_0.mcap']}
    expected['files'][0]['path'] = 'ours_0.mcap'
    assert found == expected


def test_type_hash_is_the_one_ros_shows():
    # `ros2 topic info --verbose` on Jazzy for std_msgs/msg/String.
    shown = 'RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18'
    assert generate_definition('std_msgs/msg/String').rihs01 == shown


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
