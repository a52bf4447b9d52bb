# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""An import of a damaged bag opens everywhere, holds all that was whole, and says what is lost."""

import shutil

from lta_bag import BagWriter, build_offered_qos
from lta_bag.reader import read_bag
from lta_config.errors import BadInput
from lta_data.importers.run import import_logs, ImportRequest
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
import numpy as np
import pytest
from rosbags.rosbag2 import Reader

from .damaged_bags import by_us, CHUNKS, PER_CHUNK


@pytest.fixture
def whole(tmp_path):
    """Return a whole recording in tmp_path/bag."""
    return by_us(tmp_path / 'bag')


def damage(tmp_path, data, metadata=True):
    (tmp_path / 'bag' / 'bag_0.mcap').write_bytes(data)
    if not metadata:
        (tmp_path / 'bag' / 'metadata.yaml').unlink()
    return tmp_path / 'bag'


def hit(whole, chunk):
    data = bytearray(whole.data)
    data[whole.chunks[chunk].packed[0] + 20] ^= 0xFF
    return bytes(data)


def mend(source, out):
    """Import a bag without a mapping; return the remarks."""
    (done,) = import_logs(ImportRequest([source]), out)
    return done.notes


def check_whole(folder, expected):
    """Assert that independent readers find the messages (log time, data), and we no loss."""
    bag = read_bag(folder)
    assert (bag.losses, bag.remarks) == ([], [])
    assert [(time, data) for _, time, data in bag.iterate_messages()] == expected
    with Reader(folder) as reader:
        assert [(time, data) for _, time, data in reader.messages()] == expected
        assert reader.message_count == len(expected)
    [file] = folder.glob('*.mcap')
    with file.open('rb') as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert [(m.log_time, m.data) for _, _, m in reader.iter_messages()] == expected
        assert reader.get_summary().statistics.message_count == len(expected)


def test_damaged_chunk(tmp_path, whole):
    source = damage(tmp_path, hit(whole, 3))
    notes = mend(source, tmp_path / 'new')
    left = [m for i, chunk in enumerate(whole.chunks) if i != 3 for m in chunk.messages]
    check_whole(tmp_path / 'new' / 'bag', left)
    lost = whole.chunks[3]
    assert f'The {lost.end - lost.start} bytes from byte {lost.start} on are damaged' in str(notes)


@pytest.mark.parametrize('what', ['end', 'metadata', 'summary'])
def test_what_can_be_made_anew(tmp_path, whole, what):
    data = bytearray(whole.data)
    if what == 'summary':
        data[-300] ^= 1
    source = damage(tmp_path, data[:-1] if what == 'end' else data, metadata=what != 'metadata')
    mend(source, tmp_path / 'new')
    check_whole(tmp_path / 'new' / 'bag', [m for chunk in whole.chunks for m in chunk.messages])


@pytest.mark.parametrize('compression', [*CompressionType])
def test_the_messages_before_the_cut_in_the_only_chunk_are_read(tmp_path, compression):
    file = tmp_path / 'one.mcap'
    with file.open('wb') as stream:
        writer = Writer(stream, chunk_size=10_000_000, compression=compression)
        writer.start('ros2')
        schema = writer.register_schema('std_msgs/msg/String', 'ros2msg', b'string data')
        channel = writer.register_channel('/text', 'cdr', schema)
        # Noise, which no compression makes smaller
        noise = np.random.default_rng(0)
        sent = [(i, b'\0\1\0\0' + noise.bytes(400)) for i in range(1500)]
        for time, data in sent:
            writer.add_message(channel, time, data, time)
        writer.finish()
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    bag = read_bag(file)
    kept = [(time, data) for _, time, data in bag.iterate_messages()]
    assert kept == sent[: len(kept)]
    assert len(kept) > 50
    assert 'is cut off; the messages before the cut are read' in bag.losses[0]


def test_provenance_qos_and_types_stay(tmp_path, whole):
    mend(damage(tmp_path, hit(whole, 0)), tmp_path / 'new')
    bag = read_bag(tmp_path / 'new' / 'bag')
    assert bag.provenance['seed'] == '8'
    assert bag.provenance['source'] == 'bag'
    assert 'data' not in bag.provenance
    assert {topic.type_name for topic in bag.topics.values()} == {
        'std_msgs/msg/Bool',
        'sensor_msgs/msg/Image',
        'std_msgs/msg/String',
    }
    with BagWriter(tmp_path / 'q', {}) as writer:
        writer.add_topic(
            '/x', 'std_msgs/msg/Bool', [build_offered_qos('best_effort', 'volatile', 7)]
        )
        writer.write('/x', b'\0\1\0\0\1', 5)
    file = tmp_path / 'q' / 'q_0.mcap'
    file.write_bytes(file.read_bytes()[:-1])
    mend(tmp_path / 'q', tmp_path / 'q2')
    with Reader(tmp_path / 'q2' / 'bag') as reader:
        [link] = reader.connections
        assert [(q.depth, q.reliability.name) for q in link.ext.offered_qos_profiles] == [
            (7, 'BEST_EFFORT')
        ]


def test_types_that_nobody_knows_are_copied_as_they_are(tmp_path):
    definitions = {
        '/own': ('own/msg/Thing', 'ros2msg', 'cdr', b'int32 a\nstring b'),
        '/proto': ('pkg.Thing', 'protobuf', 'protobuf', bytes(range(256))),
        '/json': ('', '', 'json', b''),
    }
    with (tmp_path / 'odd.mcap').open('wb') as stream:
        writer = Writer(stream)
        writer.start('ros2')
        for i, (topic, (name, encoding, messages, text)) in enumerate(definitions.items()):
            schema = writer.register_schema(name, encoding, text) if name else 0
            channel = writer.register_channel(topic, messages, schema)
            writer.add_message(channel, 10 + i, b'{"a": 1}', 9)
        writer.finish()
    data = (tmp_path / 'odd.mcap').read_bytes()
    (tmp_path / 'odd.mcap').write_bytes(data[:-1])
    mend(tmp_path / 'odd.mcap', tmp_path / 'new')
    with (tmp_path / 'new' / 'bag' / 'bag_0.mcap').open('rb') as stream:
        found = {
            channel.topic: (schema.name, schema.encoding, channel.message_encoding, schema.data)
            for schema, channel, _ in make_reader(stream).iter_messages()
        }
    assert found == definitions


def test_several_files_become_one(tmp_path, whole):
    source = damage(tmp_path, whole.data)
    (source / 'metadata.yaml').unlink()
    for i in (1, 2):
        shutil.copy(source / 'bag_0.mcap', source / f'bag_{i}.mcap')
    (source / 'bag_1.mcap').write_bytes(b'')
    (source / 'bag_2.mcap').write_bytes(whole.data[: whole.chunks[1].start + 9])
    notes = mend(source, tmp_path / 'new')
    new = read_bag(tmp_path / 'new' / 'bag')
    assert len(list(new.iterate_messages())) == CHUNKS * PER_CHUNK + PER_CHUNK
    assert any('bag_1.mcap' in note and 'is empty' in note for note in notes)
    assert new.is_complete


def test_a_bag_without_a_whole_message_is_refused_with_the_loss(tmp_path, whole):
    damage(tmp_path, whole.data[: whole.chunks[0].start + 10])
    with pytest.raises(BadInput, match='has no message that can be read: The recording was not'):
        mend(tmp_path / 'bag', tmp_path / 'new')
