"""A mended bag opens everywhere, holds all that was whole, and says what is not in it."""

import hashlib
import json
import shutil

from lta_bridge.bag import BagWriter, build_offered_qos
from lta_cli.app import build_app
from lta_config.errors import BadInput
from lta_data.bag import read_bag
from lta_data.bag.recover import recover_bag
from mcap.reader import make_reader
from mcap.writer import Writer
import pytest
from rosbags.rosbag2 import Reader
from typer.testing import CliRunner

from .damaged_bags import by_us, CHUNKS, PER_CHUNK

SEAL = PER_CHUNK // 3  # messages of each of the three topics in a chunk


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


def prints(folder):
    """Return what tells whether anything in a folder has changed."""
    return {
        path: (hashlib.sha256(path.read_bytes()).hexdigest(), path.stat().st_mtime_ns)
        for path in folder.rglob('*')
    }


def check_whole(folder, expected):
    """Assert that independent readers find the messages (log time, data), and we no loss."""
    bag = read_bag(folder)
    assert (bag.losses, bag.remarks, bag.is_indexed) == ([], [], True)
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
    before = prints(source)
    found = recover_bag(source, tmp_path / 'new')
    left = [m for i, chunk in enumerate(whole.chunks) if i != 3 for m in chunk.messages]
    check_whole(tmp_path / 'new', left)
    assert prints(source) == before
    lost = whole.chunks[3]
    assert found.messages == len(left) == (CHUNKS - 1) * PER_CHUNK
    assert found.lost_bytes == lost.end - lost.start
    assert found.missing == dict.fromkeys(['/lta1/a', '/lta1/b', '/c'], SEAL)
    assert '/lta1/a lacks 4 messages.' in found.describe_losses()


def test_cut_bag_with_the_metadata_of_the_whole(tmp_path, whole):
    source = damage(tmp_path, whole.data[: whole.chunks[5].start + 50])
    found = recover_bag(source, tmp_path / 'new')
    check_whole(tmp_path / 'new', [m for chunk in whole.chunks[:5] for m in chunk.messages])
    assert found.lost_bytes == 50
    assert {*found.missing.values()} == {3 * SEAL}


def test_bag_that_only_lacks_its_end_loses_nothing(tmp_path, whole):
    found = recover_bag(damage(tmp_path, whole.data[:-1]), tmp_path / 'new')
    assert found.messages == CHUNKS * PER_CHUNK
    assert found.missing == {}
    check_whole(tmp_path / 'new', [m for chunk in whole.chunks for m in chunk.messages])


@pytest.mark.parametrize('what', ['metadata', 'summary'])
def test_what_can_be_made_anew(tmp_path, whole, what):
    source = damage(tmp_path, whole.data, metadata=what == 'summary')
    if what == 'summary':
        data = bytearray(whole.data)
        data[-300] ^= 1
        source = damage(tmp_path, data)
    found = recover_bag(source, tmp_path / 'new')
    assert found.messages == CHUNKS * PER_CHUNK
    assert found.describe_losses()[-1] == 'No message is known to be lost.'
    check_whole(tmp_path / 'new', [m for chunk in whole.chunks for m in chunk.messages])


def test_provenance_qos_and_types_stay(tmp_path, whole):
    recover_bag(damage(tmp_path, hit(whole, 0)), tmp_path / 'new')
    bag = read_bag(tmp_path / 'new')
    assert bag.provenance['seed'] == '8'
    assert bag.provenance['recovered_from'].startswith(str(tmp_path / 'bag'))
    assert 'are damaged' in bag.provenance['recovered_without']
    assert {topic.type_name for topic in bag.topics.values()} == {
        'std_msgs/msg/Bool',
        'sensor_msgs/msg/Image',
        'std_msgs/msg/String',
    }
    with BagWriter(tmp_path / 'q', {}) as writer:
        writer.add_topic(
            '/x', 'std_msgs/msg/Bool', [build_offered_qos('best_effort', 'volatile', 7)]
        )
        writer.write('/x', b'\0\1\0\0\1', 5, 3)
    file = tmp_path / 'q' / 'q_0.mcap'
    file.write_bytes(file.read_bytes()[:-1])
    recover_bag(tmp_path / 'q', tmp_path / 'q2')
    with (tmp_path / 'q2' / 'q2_0.mcap').open('rb') as stream:
        [(_, _, message)] = make_reader(stream).iter_messages()
        assert (message.log_time, message.publish_time) == (5, 3)
    with Reader(tmp_path / 'q2') as reader:
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
    recover_bag(tmp_path / 'odd.mcap', tmp_path / 'new')
    with (tmp_path / 'new' / 'new_0.mcap').open('rb') as stream:
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
    found = recover_bag(source, tmp_path / 'new')
    assert found.messages == CHUNKS * PER_CHUNK + PER_CHUNK
    assert any('bag_1.mcap' in loss and 'is empty' in loss for loss in found.losses)
    assert read_bag(tmp_path / 'new').is_complete


def test_what_is_whole_or_empty_is_refused(tmp_path, whole):
    source = tmp_path / 'bag'
    with pytest.raises(BadInput, match=r'is intact: all 96 messages are readable'):
        recover_bag(source, tmp_path / 'new')
    assert not (tmp_path / 'new').exists()
    damage(tmp_path, whole.data[: whole.chunks[0].start + 10])
    with pytest.raises(BadInput, match='contains no intact message; there is nothing to recover'):
        recover_bag(source, tmp_path / 'new')
    damage(tmp_path, hit(whole, 1))
    with pytest.raises(BadInput, match='is inside the recording itself, which must not'):
        recover_bag(source, source / 'new')
    (tmp_path / 'new').mkdir()
    (tmp_path / 'new' / 'file').touch()
    with pytest.raises(BadInput, match='is not empty; choose another folder'):
        recover_bag(source, tmp_path / 'new')


def test_verb(tmp_path, whole):
    source = damage(tmp_path, hit(whole, 1))
    result = CliRunner().invoke(build_app(), ['bag', 'recover', str(source), '--json'])
    assert result.exit_code == 0
    told = json.loads(result.stdout)
    assert told['messages'] == (CHUNKS - 1) * PER_CHUNK
    assert told['missing']['/c'] == SEAL
    assert read_bag(tmp_path / 'bag-recovered').is_complete
    result = CliRunner().invoke(
        build_app(), ['bag', 'recover', str(source), '--out', str(tmp_path / 'n')]
    )
    assert result.exit_code == 0
    assert '/c lacks 4 messages.' in result.stdout
    again = CliRunner().invoke(build_app(), ['bag', 'recover', str(tmp_path / 'n')])
    assert isinstance(again.exception, BadInput)  # which `lta` turns into status 2
