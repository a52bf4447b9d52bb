"""A bag of several files: each whole alone, all of them one bag, whatever ends the recording."""

import errno
import os
import subprocess
import sys

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_bridge.bag import BagWriter, build_offered_qos, storage, StorageFault
from lta_bridge.bag.storage import SplitLimits
from lta_data.bag.reader import read_bag
from mcap.reader import make_reader
import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
import yaml

S = 10**9
QOS = [build_offered_qos('reliable', 'volatile', 10)]


def described(folder):
    return yaml.safe_load((folder / 'metadata.yaml').read_text())['rosbag2_bagfile_information']


def times(path):
    with path.open('rb') as stream:
        return [found.log_time for *_, found in make_reader(stream).iter_messages()]


def test_files_of_a_second_each_can_be_read_alone_and_together(tmp_path, random_message):
    rng = np.random.default_rng(3)
    sent = [(k * S // 4, random_message('sensor_msgs/msg/Range', rng)[1]) for k in range(18)]
    with BagWriter(tmp_path / 'bag', {'seed': '3'}, SplitLimits(duration_ns=S)) as bag:
        bag.add_topic('/lta1/range', 'sensor_msgs/msg/Range', QOS)
        bag.add_topic('/quiet', 'std_msgs/msg/Bool', [])
        for when, data in sent:
            bag.write('/lta1/range', data, when)

    by_hand = [[k * S // 4 for k in range(4 * n, min(4 * n + 4, 18))] for n in range(5)]
    told = described(tmp_path / 'bag')
    assert told['relative_file_paths'] == [f'bag_{n}.mcap' for n in range(5)]
    assert [
        (each['starting_time']['nanoseconds_since_epoch'], each['duration']['nanoseconds'])
        for each in told['files']
    ] == [(part[0], part[-1] - part[0]) for part in by_hand]
    assert [each['message_count'] for each in told['files']] == [4, 4, 4, 4, 2]
    assert (told['message_count'], told['duration']['nanoseconds']) == (18, 17 * S // 4)
    counts = [each['message_count'] for each in told['topics_with_message_count']]
    assert counts == [18, 0]

    for n, part in enumerate(by_hand):
        alone = tmp_path / 'bag' / f'bag_{n}.mcap'
        assert times(alone) == part
        with alone.open('rb') as stream:
            reader = make_reader(stream, validate_crcs=True)
            summary = reader.get_summary()
            assert [m.metadata for m in reader.iter_metadata()] == [{'seed': '3'}]
        assert [channel.topic for channel in summary.channels.values()] == [
            '/lta1/range',
            '/quiet',
        ]
        assert summary.schemas[1].name == 'sensor_msgs/msg/Range'
        with AnyReader([alone]) as reader:  # decodes by what the file itself defines
            assert [reader.deserialize(d, c.msgtype) for c, _, d in reader.messages()]
    with AnyReader([tmp_path / 'bag']) as reader:
        assert [(when, data) for _, when, data in reader.messages()] == sent
    ours = read_bag(tmp_path / 'bag')
    assert ours.is_complete
    assert [(when, data) for _, when, data in ours.iterate_messages()] == sent


def test_files_of_a_size_grow_by_one_chunk_at_most(tmp_path):
    noise, limit = np.random.default_rng(1), 300_000
    with BagWriter(tmp_path / 'bag', {}, SplitLimits(size=limit)) as bag:
        bag.add_topic('/i', 'sensor_msgs/msg/Image', [])
        for k in range(100):
            bag.write('/i', noise.bytes(20_000), k)
            if k % 5 == 4:
                bag.flush()  # chunks of 100 kB that nothing can compress
    sizes = [(tmp_path / 'bag' / f'bag_{n}.mcap').stat().st_size for n in range(7)]
    assert all(limit <= size < limit + 105_000 for size in sizes[:-1])
    assert sum(each['message_count'] for each in described(tmp_path / 'bag')['files']) == 100


def test_what_every_file_begins_with_fills_none(tmp_path):
    with BagWriter(tmp_path / 'bag', {'file': 'x' * 5000}, SplitLimits(size=10)) as bag:
        bag.add_topic('/b', 'std_msgs/msg/Bool', [])
        for k in range(6):
            bag.write('/b', b'\0\1\0\0\0', k)
            if k % 2:
                bag.flush()
    assert [each['message_count'] for each in described(tmp_path / 'bag')['files']] == [2, 2, 2]


def test_what_publishers_offer_later_is_in_the_next_file_and_in_the_metadata(tmp_path):
    late = [*QOS, build_offered_qos('best_effort', 'volatile', 5)]
    with BagWriter(tmp_path / 'bag', {}, SplitLimits(duration_ns=S)) as bag:
        bag.add_topic('/b', 'std_msgs/msg/Bool', QOS)
        bag.write('/b', b'\0\1\0\0\0', 0)
        bag.update_qos('/b', late)
        bag.write('/b', b'\0\1\0\0\0', S)
    found = []
    for n in range(2):
        with (tmp_path / 'bag' / f'bag_{n}.mcap').open('rb') as stream:
            channel = make_reader(stream).get_summary().channels[1]
        found.append(yaml.safe_load(channel.metadata['offered_qos_profiles']))
    assert found == [QOS, late]
    topic = described(tmp_path / 'bag')['topics_with_message_count'][0]['topic_metadata']
    assert topic['offered_qos_profiles'] == late


@settings(max_examples=25)
@given(
    steps=st.lists(st.tuples(st.integers(0, 2 * S), st.integers(1, 400), st.booleans())),
    split=st.builds(SplitLimits, st.integers(0, 2000), st.integers(0, 5 * S)),
)
def test_however_it_is_split_nothing_is_lost_or_moved(tmp_path_factory, steps, split):
    folder = tmp_path_factory.mktemp('law')
    now, sent = 0, []
    with BagWriter(folder / 'bag', {}, split) as bag:
        bag.add_topic('/i', 'sensor_msgs/msg/Image', [])
        for step, size, flush in steps:
            now += step
            sent.append((now, bytes(size)))
            bag.write('/i', bytes(size), now)
            if flush:
                bag.flush()
    with Reader(folder / 'bag') as reader:
        assert [(when, bytes(data)) for _, when, data in reader.messages()] == sent
        assert reader.message_count == len(sent)


KILLED = """
import os, signal, sys
from pathlib import Path
from lta_bridge.bag import BagWriter, metadata, storage
from lta_bridge.bag.storage import SplitLimits

def record(folder, fatal):
    calls = 0
    def dying(call):
        def do(*words, **named):
            nonlocal calls
            calls += 1
            if calls == fatal:
                os.kill(os.getpid(), signal.SIGKILL)
            return call(*words, **named)
        return do
    bag = BagWriter(folder, {'seed': '9'}, SplitLimits(duration_ns=10))
    bag.add_topic('/b', 'std_msgs/msg/Bool', [])
    for k in range(10):
        bag.write('/b', bytes([0, 1, 0, 0, k]), k)
        if k == 4:
            bag.flush()
    for name in ('open', 'pwrite', 'fsync', 'close'):
        setattr(storage.os, name, dying(getattr(os, name)))
    Path.replace = dying(Path.replace)
    bag.write('/b', bytes([0, 1, 0, 0, 10]), 10)
    bag.flush()
    return calls

for fatal in range(1, 100):
    child = os.fork()
    if not child:
        record(Path(sys.argv[1]) / str(fatal), fatal)
        os._exit(0)
    if os.waitpid(child, 0)[1] == 0:
        print(fatal - 1)
        break
"""


def test_a_kill_at_any_step_of_a_split_loses_nothing_that_was_flushed(tmp_path):
    done = subprocess.run(
        [sys.executable, '-c', KILLED, str(tmp_path)],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {'PYTHONPATH': os.pathsep.join(sys.path)},
    )
    steps = int(done.stdout)
    assert steps >= 8  # the old chunk, the new file and its head, summary, metadata
    for fatal in range(1, steps + 1):
        folder = tmp_path / str(fatal)
        bag = read_bag(folder)
        found = [when for _, when, _ in bag.iterate_messages()]
        assert found == list(range(len(found))), fatal
        assert len(found) >= (5 if fatal == 1 else 10), fatal
        assert bag.provenance == {'seed': '9'}
        listed = described(folder)
        for each in listed['files'][:-1]:  # the files that were closed
            assert times(folder / each['path']) == list(range(each['message_count']))
        assert [each['path'] for each in listed['files']] in (
            [f'{fatal}_0.mcap'],
            [f'{fatal}_0.mcap', f'{fatal}_1.mcap'],
        )


class Full:
    """Stands in for the system: takes so many writes, then none."""

    def __init__(self, left):
        self.left = left
        self.write = os.pwrite

    def pwrite(self, fd, data, offset):
        self.left -= 1
        if self.left < 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return self.write(fd, data, offset)


@pytest.mark.parametrize('room', [1, 2])  # the old chunk, the head of the new file
def test_a_disk_that_fills_in_a_split_leaves_what_was_flushed(tmp_path, monkeypatch, room):
    bag = BagWriter(tmp_path / 'bag', {}, SplitLimits(duration_ns=10))
    bag.add_topic('/b', 'std_msgs/msg/Bool', [])
    for k in range(10):
        bag.write('/b', b'\0\1\0\0\0', k)
    monkeypatch.setattr(storage.os, 'pwrite', Full(room).pwrite)
    with pytest.raises(StorageFault, match='stays readable'):
        bag.write('/b', b'\0\1\0\0\0', 10)
    assert bag.lost_count == 1
    monkeypatch.undo()
    bag.close()  # there is room again, as `reserve` sees to
    assert [when for _, when, _ in read_bag(tmp_path / 'bag').iterate_messages()] == list(
        range(10)
    )
    files = sorted(path.name for path in (tmp_path / 'bag').iterdir())
    assert files == sorted([*described(tmp_path / 'bag')['relative_file_paths'], 'metadata.yaml'])
