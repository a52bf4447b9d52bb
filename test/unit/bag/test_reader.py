# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whole, torn and damaged recordings: what comes back is what was whole, and the rest is told."""

import shutil

from lta_bag import BagWriter
from lta_bag.reader import read_bag
from lta_config.errors import BadInput
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer
import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import get_typestore, Stores

CHUNKS, PER_CHUNK = 12, 25


@pytest.fixture(scope='module')
def torn(tmp_path_factory):
    """Return folder, file bytes and the chunks' (end offset, messages so far)."""
    folder = tmp_path_factory.mktemp('torn') / 'bag'
    rng = np.random.default_rng(8)
    with BagWriter(folder, {'seed': '8'}) as bag:
        bag.add_topic('/a', 'std_msgs/msg/Bool', [])
        bag.add_topic('/b', 'sensor_msgs/msg/Image', [])
        for i in range(CHUNKS * PER_CHUNK):
            bag.write('/a' if i % 3 else '/b', b'\0\1\0\0' + rng.bytes(60), 1000 + i)
            if i % PER_CHUNK == PER_CHUNK - 1:
                bag.flush()
    file = folder / 'bag_0.mcap'
    with file.open('rb') as stream:
        chunks = make_reader(stream).get_summary().chunk_indexes
    return folder, file.read_bytes(), [(c.chunk_start_offset, c.chunk_length) for c in chunks]


def expected(data, chunks, cut):
    """Count the messages in the chunks that end before a cut."""
    return PER_CHUNK * sum(offset + length <= cut for offset, length in chunks)


def check_cut(place, data, chunks, cut):
    place.write_bytes(data[:cut])
    bag = read_bag(place)
    got = list(bag.iterate_messages())
    assert [time for _, time, _ in got] == [1000 + i for i in range(expected(data, chunks, cut))]
    assert sum(topic.count for topic in bag.topics.values()) == len(got)
    assert bag.is_complete == (cut == len(data))
    assert len(bag.losses) == (cut != len(data))
    return got


def test_cut_anywhere_gives_every_whole_chunk(torn, tmp_path):
    folder, data, chunks = torn
    cuts = {offset + length + d for offset, length in chunks for d in (-1, 0, 1)}
    cuts |= {offset + d for offset, _ in chunks for d in (-1, 0, 1)}
    cuts |= set(range(8, 60)) | set(range(len(data) - 40, len(data) + 1))
    cuts |= set(np.random.default_rng(1).integers(8, len(data), 200).tolist())
    whole = list(read_bag(folder).iterate_messages())
    assert len(whole) == CHUNKS * PER_CHUNK
    for cut in sorted(cuts):
        got = check_cut(tmp_path / 'cut.mcap', data, chunks, cut)
        assert [(t, d) for t, _, d in got] == [(t, d) for t, _, d in whole[: len(got)]]


@pytest.mark.parametrize('cut', range(1, 8))
def test_cut_before_the_first_record_is_not_a_recording(torn, tmp_path, cut):
    (tmp_path / 'cut.mcap').write_bytes(torn[1][:cut])
    with pytest.raises(BadInput, match='not an MCAP recording'):
        read_bag(tmp_path / 'cut.mcap')


def test_zeros_at_the_end_are_no_records(torn, tmp_path):
    _, data, chunks = torn
    offset, length = chunks[4]
    (tmp_path / 'cut.mcap').write_bytes(data[: offset + length] + bytes(5000))
    bag = read_bag(tmp_path / 'cut.mcap')
    assert len(list(bag.iterate_messages())) == 5 * PER_CHUNK
    assert bag.losses == [
        f'The recording was not finished: the last 5000 of {offset + length + 5000} bytes are '
        'not a complete record.'
    ]


@pytest.mark.parametrize('finished', [True, False])
def test_damaged_chunk_is_left_out_and_told(torn, tmp_path, finished):
    _, data, chunks = torn
    offset, length = chunks[3]
    middle = offset + length // 2
    broken = data[:middle] + bytes([data[middle] ^ 0xFF]) + data[middle + 1 :]
    (tmp_path / 'bad.mcap').write_bytes(broken if finished else broken[:-1])
    bag = read_bag(tmp_path / 'bad.mcap')
    for _ in range(2):
        times = [time for _, time, _ in bag.iterate_messages()]
        gone = range(1000 + 3 * PER_CHUNK, 1000 + 4 * PER_CHUNK)
        assert times == [t for t in range(1000, 1000 + CHUNKS * PER_CHUNK) if t not in gone]
    told = f'The {length} bytes from byte {offset} on are damaged; their content is left out.'
    assert told in bag.losses
    assert len(bag.losses) == (1 if finished else 2)
    assert not bag.is_complete


def test_damaged_summary_is_not_believed(torn, tmp_path):
    _, data, _ = torn
    for place in (len(data) - 400, len(data) - 100, len(data) - 20):
        broken = bytearray(data)
        broken[place] ^= 1
        (tmp_path / 'bad.mcap').write_bytes(broken)
        got = list(read_bag(tmp_path / 'bad.mcap').iterate_messages())
        assert len(got) == CHUNKS * PER_CHUNK


def test_topics_and_provenance_of_a_finished_folder(torn):
    bag = read_bag(torn[0])
    counts = {name: (topic.type_name, topic.count) for name, topic in bag.topics.items()}
    assert counts == {'/a': ('std_msgs/msg/Bool', 200), '/b': ('sensor_msgs/msg/Image', 100)}
    assert (bag.start, bag.end) == (1000, 1000 + CHUNKS * PER_CHUNK - 1)
    assert bag.provenance == {'seed': '8'}
    assert [t for t, _, _ in bag.iterate_messages(['/b'])] == ['/b'] * 100
    with pytest.raises(BadInput, match=r"Unknown topic '/c'; known: /a, /b\."):
        list(bag.iterate_messages(['/c']))


def test_provenance_outlives_either_of_its_places(torn, tmp_path):
    _, data, chunks = torn
    (tmp_path / 'lone.mcap').write_bytes(data[: chunks[0][0]])
    assert read_bag(tmp_path / 'lone.mcap').provenance == {'seed': '8'}
    types = get_typestore(Stores.ROS2_JAZZY)
    writer = RosbagsWriter(tmp_path / 'theirs', version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_custom_data('operator', 'me')
    with writer:
        link = writer.add_connection('/x', 'std_msgs/msg/Bool', typestore=types)
        writer.write(link, 5, b'\0\1\0\0\1')
    assert read_bag(tmp_path / 'theirs').provenance == {'operator': 'me'}


@pytest.mark.parametrize('mode', [CompressionMode.NONE, CompressionMode.STORAGE])
def test_bags_of_rosbags_are_read(tmp_path, mode):
    types = get_typestore(Stores.ROS2_JAZZY)
    writer = RosbagsWriter(tmp_path / 'theirs', version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        links = [
            writer.add_connection(name, 'std_msgs/msg/Bool', typestore=types)
            for name in ('/x', '/y')
        ]
        for i in range(100):
            writer.write(links[i % 2], 50 + i, bytes([0, 1, 0, 0, i % 3 == 0]))
    bag = read_bag(tmp_path / 'theirs')
    with Reader(tmp_path / 'theirs') as reader:
        theirs = [(c.topic, t, d) for c, t, d in reader.messages()]
    assert list(bag.iterate_messages()) == theirs
    assert bag.decode('/x', theirs[0][2]).data is True


@pytest.mark.parametrize('compression', list(CompressionType))
@pytest.mark.parametrize('chunked', [True, False])
@pytest.mark.parametrize('indexed', [True, False])
def test_every_kind_of_mcap_is_read(tmp_path, compression, chunked, indexed):
    with (tmp_path / 'any.mcap').open('wb') as stream:
        writer = Writer(
            stream,
            chunk_size=300,
            compression=compression,
            index_types=IndexType.ALL if indexed else IndexType.NONE,
            use_chunking=chunked,
            use_statistics=indexed,
        )
        writer.start('ros2')
        schema = writer.register_schema('std_msgs/msg/Bool', 'ros2msg', b'bool data')
        channels = [writer.register_channel(name, 'cdr', schema) for name in ('/x', '/y')]
        for i in range(90):
            writer.add_message(channels[i % 3 == 0], 7 + i, bytes([0, 1, 0, 0, 1]), 7 + i)
        writer.finish()
    bag = read_bag(tmp_path / 'any.mcap')
    assert [time for _, time, _ in bag.iterate_messages()] == list(range(7, 97))
    assert {name: topic.count for name, topic in bag.topics.items()} == {'/x': 60, '/y': 30}
    assert [time for _, time, _ in bag.iterate_messages(['/y'])] == list(range(7, 97, 3))
    assert bag.is_complete
    assert bag.decode('/x', b'\0\1\0\0\1').data is True


def test_split_bag_is_one(torn, tmp_path):
    folder = tmp_path / 'split'
    folder.mkdir()
    for i in (0, 1, 2, 10):
        shutil.copy(torn[0] / 'bag_0.mcap', folder / f'split_{i}.mcap')
    (folder / 'split_10.mcap').write_bytes(torn[1][:-1])
    bag = read_bag(folder)
    assert bag.topics['/a'].count == 800
    assert len(list(bag.iterate_messages())) == 4 * CHUNKS * PER_CHUNK
    assert len(bag.losses) == 1


def test_what_is_no_bag_is_told_so(tmp_path):
    with pytest.raises(BadInput, match=r"no_bag' does not exist; give a rosbag2 folder"):
        read_bag(tmp_path / 'no_bag')
    with pytest.raises(BadInput, match=r'contains no \.mcap file'):
        read_bag(tmp_path)
    (tmp_path / 'empty.mcap').touch()
    with pytest.raises(BadInput, match=r'is empty \(0 bytes\): nothing was recorded'):
        read_bag(tmp_path / 'empty.mcap')
    (tmp_path / 'log.txt').write_text('hello, this is not a bag')
    with pytest.raises(BadInput, match='is not an MCAP recording'):
        read_bag(tmp_path / 'log.txt')
    (tmp_path / 'old').mkdir()
    (tmp_path / 'old' / 'old_0.db3').touch()
    with pytest.raises(
        BadInput, match=r'in SQLite format \(\.db3\); convert it to MCAP with `lta import`\.$'
    ):
        read_bag(tmp_path / 'old')


@pytest.mark.parametrize('text', ['', ': {', '[1, 2]', 'rosbag2_bagfile_information: 3', '\0'])
def test_broken_metadata_file_does_not_matter(torn, tmp_path, text):
    shutil.copytree(torn[0], tmp_path / 'bag')
    (tmp_path / 'bag' / 'metadata.yaml').write_text(text)
    bag = read_bag(tmp_path / 'bag')
    assert bag.topics['/a'].count == 200
    assert bag.provenance == {'seed': '8'}


def test_message_that_does_not_fit_its_definition_is_told(tmp_path):
    with BagWriter(tmp_path / 'bag', {}) as writer:
        writer.add_topic('/odom', 'nav_msgs/msg/Odometry', [])
        writer.write('/odom', b'\0\1\0\0\1\2', 1)
    bag = read_bag(tmp_path / 'bag')
    [(topic, _, data)] = bag.iterate_messages()
    with pytest.raises(BadInput, match="definition of its type 'nav_msgs/msg/Odometry'"):
        bag.decode(topic, data)
