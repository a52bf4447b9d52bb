# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Strange recordings: each oddity is one sentence, and the rest is read."""

from lta_bag import BagWriter
from lta_bag.mcap_file import chunks
from lta_bag.mcap_file.decoder import explain_undecodable
from lta_bag.reader import read_bag
from lta_config.errors import BadInput
from lta_data.bag import summarize_bag
from mcap.data_stream import RecordBuilder
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, Header, Message, Schema
from mcap.writer import CompressionType, MCAP0_MAGIC, Writer
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import get_typestore, Stores
import zstandard

TRUE = b'\0\1\0\0\1'


def encode_records(records):
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return builder.end()


def write(path, topics, messages, **options):
    """Write topics {name: (type, encoding, message encoding, text)} and (topic, time) by mcap."""
    with path.open('wb') as stream:
        writer = Writer(stream, **options)
        writer.start('ros2')
        channels = {}
        for topic, (name, encoding, message_encoding, text) in topics.items():
            schema = writer.register_schema(name, encoding, text) if name else 0
            channels[topic] = writer.register_channel(topic, message_encoding, schema)
        for topic, time in messages:
            writer.add_message(channels[topic], time, TRUE, time)
        writer.finish()
    return path


BOOL = ('std_msgs/msg/Bool', 'ros2msg', 'cdr', b'bool data')
ODD = {
    '/proto': (('p.Thing', 'protobuf', 'protobuf', b'\xff'), "are encoded as 'protobuf', not as"),
    '/idl': (('p/msg/T', 'omgidl', 'cdr', b'x'), "are of type 'p/msg/T', defined in 'omgidl'"),
    '/none': (('', '', 'cdr', b''), 'have a message type that the bag does not define'),
    '/blank': (('p/msg/T2', 'ros2msg', 'cdr', b''), "'p/msg/T2', which the bag does not define"),
}


def test_topics_that_cannot_be_decoded_are_kept_and_shown(tmp_path):
    topics = {'/good': BOOL} | {topic: odd for topic, (odd, _) in ODD.items()}
    file = write(tmp_path / 'odd.mcap', topics, [(topic, i) for i, topic in enumerate(topics)])
    info = summarize_bag(file)
    assert {topic.name: topic.count for topic in info.topics} == dict.fromkeys(topics, 1)
    assert info.complete
    bag = read_bag(file)
    assert bag.decode('/good', TRUE).data is True
    for topic, (_, sentence) in ODD.items():
        assert [data for _, _, data in bag.iterate_messages([topic])] == [TRUE]
        with pytest.raises(BadInput, match=rf"^The messages of '{topic}' .*{sentence}.*\.$"):
            bag.decode(topic, TRUE)
        [remark] = [remark for remark in info.remarks if f"'{topic}'" in remark]
        assert sentence in remark


def test_a_message_without_fields_needs_no_text():
    assert explain_undecodable(Schema(1, b'', 'ros2msg', 'std_msgs/msg/Empty'), 'cdr') is None
    assert (
        explain_undecodable(Schema(1, b'bool data', 'ros2msg', 'std_msgs/msg/Bool'), 'cdr') is None
    )


def chunked(path, *chunks):
    """Write a file of given chunks (name, packed bytes, size, CRC), without a summary."""
    records = [
        Header('ros2', ''),
        Schema(1, b'bool data', 'ros2msg', 'std_msgs/msg/Bool'),
        Channel(1, '/x', 'cdr', {}, 1),
        *(Chunk(name, data, 0, 0, crc, size) for name, data, size, crc in chunks),
    ]
    path.write_bytes(MCAP0_MAGIC + encode_records(records))
    return path


def message(time):
    return encode_records([Message(1, time, TRUE, time, 0)])


def test_unknown_compression_is_named(tmp_path):
    good = message(7)
    file = chunked(tmp_path / 'a.mcap', ('br', b'what is this', 50, 1), ('', good, len(good), 0))
    bag = read_bag(file)
    assert [time for _, time, _ in bag.iterate_messages()] == [7]
    assert "are compressed with 'br', which is not supported" in bag.losses[0]


def test_chunks_that_claim_too_much_cost_no_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(chunks, 'CHUNK_BYTES', 1 << 20)
    zeros = bytes(4 << 20)
    told = zstandard.ZstdCompressor().compress(zeros)
    silent = zstandard.ZstdCompressor(write_content_size=False).compress(zeros)
    packed_lz4 = chunks.lz4.frame.compress(zeros, store_size=False)
    liar = bytearray(zstandard.ZstdCompressor().compress(bytes(300_000)))
    liar[5:9] = b'\xff\xff\xff\x7f'  # the content size, in 4 bytes behind magic and descriptor
    for kind, packed in (('zstd', told), ('zstd', silent), ('lz4', packed_lz4), ('zstd', liar)):
        with pytest.raises(chunks.DamagedRecord, match=r'decompress|^$'):
            chunks.decompress(kind, bytes(packed))
    good = message(7)
    bombs = [('zstd', told, len(zeros), 1), ('lz4', packed_lz4, len(zeros), 1)]
    bag = read_bag(chunked(tmp_path / 'a.mcap', *bombs, ('', good, len(good), 0)))
    assert [time for _, time, _ in bag.iterate_messages()] == [7]
    assert 'decompress to 4194304 bytes' in bag.losses[0]
    assert 'decompress to more than the limit of 1048576 bytes' in bag.losses[1]


def test_bags_without_messages(tmp_path):
    with BagWriter(tmp_path / 'bag', {}) as writer:
        writer.add_topic('/x', 'std_msgs/msg/Bool', [])
    info = summarize_bag(tmp_path / 'bag')
    assert (info.messages, info.complete, info.remarks) == (
        0,
        True,
        ['The bag contains no message.'],
    )


@pytest.mark.parametrize(
    ('head', 'sentence'),
    [
        (b'', 'is empty (0 bytes): nothing was recorded. Record it again.'),
        (
            b'SQLite format 3\0',
            'is a bag in SQLite format (.db3); convert it to MCAP with `lta import`.',
        ),
        (b'#ROSBAG V2.0\n', 'is a ROS 1 bag; convert it with `lta import`.'),
        (b'ULog\x01\x12\x35\x01', 'is a PX4 log; convert it with `lta import`.'),
        (b'\x28\xb5\x2f\xfd', 'is compressed with zstd; decompress it with `zstd -d` first.'),
        (
            b'hello, world',
            'is not an MCAP recording; give a rosbag2 folder or an .mcap file, or convert a log '
            'with `lta import`.',
        ),
    ],
)
def test_other_files_are_told_by_what_they_are(tmp_path, head, sentence):
    (tmp_path / 'x').write_bytes(head)
    with pytest.raises(BadInput) as caught:
        read_bag(tmp_path / 'x')
    assert str(caught.value) == f"'{tmp_path / 'x'}' {sentence}"


@pytest.mark.parametrize('mode', [CompressionMode.MESSAGE, CompressionMode.FILE])
def test_compression_by_message_or_file(tmp_path, mode):
    writer = RosbagsWriter(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        types = get_typestore(Stores.ROS2_JAZZY)
        link = writer.add_connection('/x', 'std_msgs/msg/Bool', typestore=types)
        writer.write(link, 5, TRUE)
    if mode is CompressionMode.FILE:
        with pytest.raises(BadInput, match='compressed with zstd; decompress it'):
            read_bag(tmp_path / 'bag')
    else:
        assert list(read_bag(tmp_path / 'bag').iterate_messages()) == [('/x', 5, TRUE)]


def test_files_that_metadata_lists_outside_are_not_read(tmp_path):
    (tmp_path / 'bag').mkdir()
    write(tmp_path / 'secret.mcap', {'/secret': BOOL}, [('/secret', 1)])
    write(tmp_path / 'bag' / 'own.mcap', {'/own': BOOL}, [('/own', 1)])
    listed = ['../secret.mcap', str(tmp_path / 'secret.mcap'), 300 * 'x' + '.mcap']
    (tmp_path / 'bag' / 'metadata.yaml').write_text(
        f'rosbag2_bagfile_information: {{relative_file_paths: {listed}}}'
    )
    bag = read_bag(tmp_path / 'bag')
    assert list(bag.topics) == ['/own']
    assert (
        "metadata.yaml lists the file 'secret.mcap', which is missing from the bag's folder."
        in bag.losses
    )


def test_thousands_of_channels(tmp_path):
    topics = {f'/t{i}': BOOL for i in range(3000)}
    file = write(tmp_path / 'a.mcap', topics, [('/t5', 1), ('/t2999', 2)])
    assert len(summarize_bag(file).topics) == 3000
    file.write_bytes(file.read_bytes()[:-1])
    assert [topic for topic, _, _ in read_bag(file).iterate_messages()] == ['/t5', '/t2999']


def test_hostile_bytes_cost_bounded_effort(tmp_path):
    claims = encode_records([Chunk('', b'', 0, 0, 1, 90_000)])[:49] + (90_000).to_bytes(
        8, 'little'
    )
    fillings = (
        b'\x05\x16' + bytes(29),  # bare messages without a channel
        b'\x06' + (90_000).to_bytes(8, 'little') + claims[9:],
        b'\x28\xb5\x2f\xfd',
        b'\x04\x22\x4d\x18',
        b'\x03' + (14).to_bytes(8, 'little') + bytes(5),
        bytes(64),
    )
    for filling in fillings:
        (tmp_path / 'a.mcap').write_bytes(MCAP0_MAGIC + filling * (60_000 // len(filling)))
        bag = read_bag(tmp_path / 'a.mcap')
        assert sum(1 for _ in bag.iterate_messages()) <= 60_000 // 31
        assert len(bag.losses) < 120


def test_lost_names_are_numbers(tmp_path):
    with BagWriter(tmp_path / 'bag', {}) as writer:
        for topic in ('/a', '/b'):
            writer.add_topic(topic, 'std_msgs/msg/Bool', [])
        for time in range(3):
            writer.write('/a' if time % 2 else '/b', TRUE, time)
            writer.flush()
    file = tmp_path / 'bag' / 'bag_0.mcap'
    with file.open('rb') as stream:
        first, *_, last = make_reader(stream).get_summary().chunk_indexes
    data = bytearray(file.read_bytes()[: last.chunk_start_offset + last.chunk_length])
    data[first.chunk_start_offset + first.chunk_length - 20] ^= 1  # the chunk with the names
    file.write_bytes(data)
    bag = read_bag(tmp_path / 'bag')
    assert [topic for topic, _, _ in bag.iterate_messages()] == ['/channel_1', '/channel_2']
    with pytest.raises(BadInput, match='a message type that the bag does not define'):
        bag.decode('/channel_1', TRUE)


def test_chunks_without_the_topic_are_not_unpacked(tmp_path, monkeypatch):
    messages = [('/often', i) for i in range(200)] + [('/rare', 201)]
    file = write(
        tmp_path / 'a.mcap',
        {'/often': BOOL, '/rare': BOOL},
        messages,
        chunk_size=300,
        compression=CompressionType.ZSTD,
    )
    seen, whole = [], chunks.decompress
    monkeypatch.setattr(
        chunks, 'decompress', lambda kind, data: seen.append(kind) or whole(kind, data)
    )
    assert len(list(read_bag(file).iterate_messages(['/rare']))) == 1
    assert len(seen) == 1
