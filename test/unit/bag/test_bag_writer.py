# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What goes wrong while recording: folders, types, deaths and disks."""

from contextlib import suppress
import errno
import os
import signal
import subprocess
import sys
import tracemalloc

from lta_bag import BagWriter, build_offered_qos, storage, StorageFault
from lta_bag.background_writer import FLUSH_PERIOD
from lta_bag.reader import read_bag
from lta_bag.schemas import generate_definition
from lta_config.errors import BadInput
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader
import numpy as np
import pytest
from rosbags.rosbag2 import Reader
import yaml

FALSE = b'\0\1\0\0\0'
RECORD = """
import itertools, sys, time
from pathlib import Path
from lta_bag import BagWriter
with BagWriter(Path(sys.argv[1]), {'seed': '9'}) as bag:
    bag.add_topic('/b', 'std_msgs/msg/Bool', [])
    for i in itertools.count():
        bag.write('/b', bytes([0, 1, 0, 0, i % 2]), i)
        if i % 100 == 99:
            bag.flush()
            print(i, flush=True)
            time.sleep(0.02)
"""


def stream_messages(path):
    """Return the log times that the mcap library finds before the file ends."""
    times = []
    with path.open('rb') as stream, suppress(Exception):  # However an unfinished file ends.
        found = StreamReader(stream, validate_crcs=True).records
        times.extend(record.log_time for record in found if isinstance(record, Message))
    return times


@pytest.mark.parametrize('kind', ['folder', 'file'])
def test_busy_place_is_refused_and_untouched(tmp_path, kind):
    place = tmp_path / 'bag'
    if kind == 'folder':
        place.mkdir()
        (place / 'mine.txt').write_text('keep')
    else:
        place.write_text('keep')
    before = sorted(tmp_path.rglob('*'))
    with pytest.raises(
        BadInput,
        match=r'(not empty; choose another folder|read \(File exists\); choose another folder)',
    ):
        BagWriter(place, {})
    assert sorted(tmp_path.rglob('*')) == before


def test_unknown_type_leaves_the_bag_as_it_was(tmp_path):
    with BagWriter(tmp_path / 'bag', {}) as bag:
        with pytest.raises(BadInput, match="Nothing' cannot be recorded, because it is neither"):
            bag.add_topic('/x', 'lta_msgs/msg/Nothing', [])
        bag.add_topic('/b', 'std_msgs/msg/Bool', [])
        with pytest.raises(BadInput, match='add each topic only once'):
            bag.add_topic('/b', 'std_msgs/msg/Bool', [])
        with pytest.raises(KeyError):
            bag.write('/x', FALSE, 0)
        bag.write('/b', FALSE, 5)
    with Reader(tmp_path / 'bag') as reader:
        assert [c.topic for c in reader.connections] == ['/b']
        assert reader.message_count == 1


def test_metadata_of_a_running_recording_names_topics_and_provenance(tmp_path):
    bag = BagWriter(tmp_path / 'bag', {'seed': '3'})
    bag.add_topic('/b', 'std_msgs/msg/Bool', [build_offered_qos('reliable', 'volatile', 1)])
    bag.flush()
    text = (tmp_path / 'bag' / 'metadata.yaml').read_text()
    bag.close()
    found = yaml.safe_load(text)['rosbag2_bagfile_information']
    assert found['custom_data'] == {'seed': '3'}
    assert found['topics_with_message_count'][0]['topic_metadata']['name'] == '/b'
    assert sorted(p.name for p in (tmp_path / 'bag').iterdir()) == ['bag_0.mcap', 'metadata.yaml']


def test_killed_process_keeps_what_was_flushed(tmp_path):
    process = subprocess.Popen(
        [sys.executable, '-c', RECORD, str(tmp_path / 'bag')],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {'PYTHONPATH': os.pathsep.join(sys.path)},
    )
    with process:
        told = [int(process.stdout.readline()) for _ in range(8)]
        process.send_signal(signal.SIGKILL)
        told += [int(line) for line in process.stdout]
    assert process.returncode == -signal.SIGKILL
    times = stream_messages(tmp_path / 'bag' / 'bag_0.mcap')
    # The kill may fall between a flush and the line that tells of it.
    assert times == list(range(len(times)))
    assert len(times) in (told[-1] + 1, told[-1] + 101)
    bag = read_bag(tmp_path / 'bag')
    assert not bag.is_complete
    assert bag.provenance == {'seed': '9'}
    read = [data[4] for _, _, data in bag.iterate_messages()]
    assert read == [i % 2 for i in range(bag.topics['/b'].count)]
    assert len(read) > told[-1]


LIMITED = """
import resource, signal, sys
from pathlib import Path
from lta_bag import BagWriter, StorageFault
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
bag = BagWriter(Path(sys.argv[1]), {'seed': '9'})
bag.add_topic('/b', 'std_msgs/msg/Bool', [])
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
import random
noise = random.Random(1)
flushed = 0
try:
    for i in range(100_000):
        bag.write('/b', bytes([0, 1, 0, 0]) + noise.randbytes(200), i)
        if i % 50 == 49:
            bag.flush()
            flushed = i + 1
except StorageFault as fault:
    print(flushed, bag.lost_count, fault.errno)
bag.close()
"""


@pytest.mark.parametrize('limit', [20_000, 65_536, 300_001])
def test_full_disk_ends_the_recording_and_not_the_bag(tmp_path, limit):
    done = subprocess.run(
        [sys.executable, '-c', LIMITED, str(tmp_path / 'bag'), str(limit)],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {'PYTHONPATH': os.pathsep.join(sys.path)},
    )
    flushed, lost, number = map(int, done.stdout.split())
    assert number == errno.EFBIG
    assert lost == 50
    assert flushed > 0
    assert (tmp_path / 'bag' / 'bag_0.mcap').stat().st_size <= limit
    assert stream_messages(tmp_path / 'bag' / 'bag_0.mcap') == list(range(flushed))
    found = yaml.safe_load((tmp_path / 'bag' / 'metadata.yaml').read_text())
    assert found['rosbag2_bagfile_information']['message_count'] == flushed


class Disk:
    """Stands in for the system: takes `room` bytes, then fails once or for good."""

    def __init__(self, room, number, for_good):
        self.room = room
        self.number = number
        self.for_good = for_good
        self.write = os.pwrite

    def pwrite(self, fd, data, offset):
        if self.room <= 0:
            if not self.for_good:
                self.room = 1 << 40
            raise OSError(self.number, os.strerror(self.number))
        done = self.write(fd, data[: self.room], offset)
        self.room -= done
        return done


@pytest.mark.parametrize('number', [errno.ENOSPC, errno.EIO, errno.EDQUOT])
def test_failed_write_is_undone_and_no_wrong_summary_written(tmp_path, monkeypatch, number):
    bag = BagWriter(tmp_path / 'bag', {})
    bag.add_topic('/b', 'std_msgs/msg/Bool', [])
    for i in range(40):
        bag.write('/b', FALSE, i)
    bag.flush()
    whole = (tmp_path / 'bag' / 'bag_0.mcap').stat().st_size
    monkeypatch.setattr(storage.os, 'pwrite', Disk(100, number, for_good=False).pwrite)
    for i in range(40, 60):
        bag.write('/b', FALSE, i)
    with pytest.raises(StorageFault, match='stays readable') as caught:
        bag.flush()
    assert caught.value.errno == number
    assert (tmp_path / 'bag' / 'bag_0.mcap').stat().st_size == whole
    assert bag.lost_count == 20
    with pytest.raises(StorageFault):
        bag.write('/b', FALSE, 60)
    bag.close()  # The fault is known already.
    with Reader(tmp_path / 'bag') as reader:
        assert [time for _, time, _ in reader.messages()] == list(range(40))
        assert reader.message_count == 40
    with (tmp_path / 'bag' / 'bag_0.mcap').open('rb') as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_summary() is None
        assert [message.log_time for *_, message in reader.iter_messages()] == list(range(40))
    ours = read_bag(tmp_path / 'bag')
    assert [time for _, time, _ in ours.iterate_messages()] == list(range(40))


def test_interrupt_in_the_middle_of_a_write_leaves_a_whole_bag(tmp_path, monkeypatch):
    noise = np.random.default_rng(1).bytes(200_000)
    write = os.pwrite

    def interrupted(fd, data, offset):
        monkeypatch.undo()
        write(fd, data[:100_000], offset)
        raise KeyboardInterrupt

    def record():
        with BagWriter(tmp_path / 'bag', {}) as bag:
            bag.add_topic('/i', 'sensor_msgs/msg/Image', [])
            bag.write('/i', noise, 1)
            bag.flush()
            bag.write('/i', noise, 2)
            monkeypatch.setattr(storage.os, 'pwrite', interrupted)
            bag.flush()

    with pytest.raises(KeyboardInterrupt):
        record()
    with Reader(tmp_path / 'bag') as reader:
        assert [(time, data == noise) for _, time, data in reader.messages()] == [(1, True)]


def test_fault_while_closing_is_told_and_leaves_a_stream(tmp_path, monkeypatch):
    bag = BagWriter(tmp_path / 'bag', {})
    bag.add_topic('/b', 'std_msgs/msg/Bool', [])
    for i in range(40):
        bag.write('/b', FALSE, i)
    bag.flush()
    monkeypatch.setattr(storage.os, 'pwrite', Disk(50, errno.ENOSPC, for_good=True).pwrite)
    with pytest.raises(StorageFault):
        bag.close()
    bag.close()
    assert stream_messages(tmp_path / 'bag' / 'bag_0.mcap') == list(range(40))


def test_reserve_covers_what_closing_writes(tmp_path):
    bag = BagWriter(tmp_path / 'bag', {'seed': '1' * 500})
    for i in range(30):
        qos = [build_offered_qos('reliable', 'volatile', 10)]
        bag.add_topic(f'/lta1/topic_{i}', 'nav_msgs/msg/Odometry', qos)
    for i in range(100):
        for k in range(30):
            bag.write(f'/lta1/topic_{k}', FALSE, i)
        bag.flush()
    reserve = bag.required_closing_space
    before = (tmp_path / 'bag' / 'bag_0.mcap').stat().st_size
    bag.close()
    used = (tmp_path / 'bag' / 'bag_0.mcap').stat().st_size - before
    used += (tmp_path / 'bag' / 'metadata.yaml').stat().st_size
    assert used <= reserve < 2 * used


def test_chunks_close_by_themselves_and_out_of_order_times_count(tmp_path):
    times = [500, 100, 900]
    with BagWriter(tmp_path / 'bag', {}) as bag:
        bag.add_topic('/i', 'sensor_msgs/msg/Image', [])
        for log_time in times:
            bag.write('/i', bytes(1 << 20), log_time)
    with (tmp_path / 'bag' / 'bag_0.mcap').open('rb') as stream:
        statistics = make_reader(stream).get_summary().statistics
    assert statistics.chunk_count == 3
    assert (statistics.message_start_time, statistics.message_end_time) == (100, 900)
    with Reader(tmp_path / 'bag') as reader:
        assert (reader.start_time, reader.duration) == (100, 801)


def test_two_hours_cost_some_megabytes_of_indexes(tmp_path):
    """Chunks with all 24 topics of a flight, each in memory until the file is closed."""
    names = [f'/t{k}' for k in range(24)]
    chunks = 300
    with BagWriter(tmp_path / 'bag', {}) as bag:
        for name in names:
            bag.add_topic(name, 'std_msgs/msg/Bool', [])
        tracemalloc.start()
        for k in range(chunks):
            if k == chunks // 10:  # whatever is made once has been made
                before = tracemalloc.get_traced_memory()[0]
            for name in names:
                bag.write(name, FALSE, 1000 * k)
            bag.flush()
        held = tracemalloc.get_traced_memory()[0] - before
        tracemalloc.stop()
    with (tmp_path / 'bag' / 'bag_0.mcap').open('rb') as stream:
        assert len(make_reader(stream).get_summary().chunk_indexes) == chunks
    assert held / (0.9 * chunks) * 7200 / FLUSH_PERIOD < 30e6


def test_a_message_of_an_installed_package_has_a_definition(tmp_path, monkeypatch):
    folder = tmp_path / 'share/lab_probe/msg'
    folder.mkdir(parents=True)
    (folder / 'Frame.msg').write_text('std_msgs/Header header\nlab_probe/Marker[] markers\n')
    (folder / 'Marker.msg').write_text('uint8 LOST=1\nuint32 id\nfloat64[3] place\n')
    (folder / 'Broken.msg').write_text('lab_probe/Nowhere[<=2] parts\n')
    (folder / 'Cut.msg').write_text('uint8[ x\n')
    (folder / 'Nested.msg').write_text('lab_probe/Nested[] inner\n')
    (folder / 'Latin.msg').write_bytes('uint8 x # \xb5m\n'.encode('latin-1'))
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path))
    text = generate_definition('lab_probe/msg/Frame').text
    head, *parts = [part.split('\n') for part in text.split('=' * 80 + '\n')]
    assert head[:2] == ['std_msgs/Header header', 'lab_probe/Marker[] markers']
    assert [part[0] for part in parts] == [
        'MSG: std_msgs/Header',
        'MSG: builtin_interfaces/Time',
        'MSG: lab_probe/Marker',
    ]
    assert generate_definition('lab_probe/msg/Latin').text.startswith('uint8 x')
    for name in ('Broken', 'Nowhere', 'Cut', 'Nested', '../msg/Frame'):
        with pytest.raises(BadInput, match='source its workspace'):
            generate_definition(f'lab_probe/msg/{name}')
