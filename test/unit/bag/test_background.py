# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A slow, full or broken disk: nobody waits for it, and what is missing is known."""

from collections import Counter
import errno
import os
import threading
from types import SimpleNamespace

from lta_bag import background_writer, BagWriter, storage, StorageFault
from lta_bag.background_writer import BackgroundWriter
from lta_bag.reader import read_bag
import pytest
from waiting import PATIENCE

TYPE = 'sensor_msgs/msg/Image'
FIRST = 777  # log time of the message that meets the stalled disk [ns]


class SlowDisk:
    """Stands in for the system: a write begins, and ends when it is let."""

    def __init__(self):
        self.stalled = threading.Event()
        self.let = threading.Event()
        self.write = os.pwrite

    def pwrite(self, fd, data, offset):
        self.stalled.set()
        assert self.let.wait(PATIENCE)
        return self.write(fd, data, offset)


def stall(folder, monkeypatch, room):
    """Return a writer whose disk takes the beginning of a message, and then its time."""
    bag, disk = BagWriter(folder, {}), SlowDisk()
    writer = BackgroundWriter(bag, room)
    for name in ('/a', '/b'):
        writer.add_topic(name, TYPE, [])
    monkeypatch.setattr(storage.os, 'pwrite', disk.pwrite)
    writer.write('/a', bytes(1000), FIRST)
    writer.submit(bag.flush)
    assert disk.stalled.wait(PATIENCE)
    return writer, disk


def stored(folder):
    return [when for _, when, _ in read_bag(folder).iterate_messages()]


def test_a_disk_that_stalls_stops_nobody_and_costs_what_finds_no_room(tmp_path, monkeypatch):
    writer, disk = stall(tmp_path / 'bag', monkeypatch, room=10_000)
    names = ['/a', '/b']
    taken = [writer.write(names[k % 2], bytes(1000), k) for k in range(15)]
    assert taken == [True] * 10 + [False] * 5  # the newest are dropped
    assert writer.dropped == Counter({'/a': 3, '/b': 2})
    assert writer.queued_bytes == 10_000
    disk.let.set()
    writer.close()
    assert writer.queued_bytes == 0
    assert stored(tmp_path / 'bag') == [FIRST, *range(10)]
    assert read_bag(tmp_path / 'bag').is_complete
    assert writer.lost_count == 0


def test_after_a_stall_recording_goes_on(tmp_path, monkeypatch):
    writer, disk = stall(tmp_path / 'bag', monkeypatch, room=2000)
    before = [writer.write('/a', bytes(1000), k) for k in range(4)]
    disk.let.set()
    caught_up = threading.Event()
    writer.submit(caught_up.set)
    assert caught_up.wait(PATIENCE)
    assert writer.write('/a', bytes(1000), 4)
    writer.close()
    assert before == [True, True, False, False]
    assert stored(tmp_path / 'bag') == [FIRST, 0, 1, 4]


class SlowSink:
    """Takes as many seconds for a message as it was logged at, and notes how busy that is."""

    def __init__(self, clock):
        self.clock, self.lost_count, self.seen = clock, 0, []

    def write(self, topic, data, log_time_ns):
        self.clock.now += log_time_ns
        self.seen.append(self.writer.busy_time)

    def flush(self):
        pass

    update_metadata = check_room = close = flush


def test_busy_is_with_one_message_not_with_all_that_waited(monkeypatch):
    """A machine that is short of time makes many messages slow, a disk makes one."""
    clock = SimpleNamespace(now=0)
    clock.monotonic = lambda: clock.now
    monkeypatch.setattr(background_writer, 'time', clock)
    sink, over = SlowSink(clock), threading.Event()
    writer = sink.writer = BackgroundWriter(sink, room=1 << 30)
    for seconds in (1, 1, 5, 1):
        writer.write('/a', b'', seconds)
    writer.submit(over.set)
    assert over.wait(PATIENCE)
    writer.close()
    assert sink.seen == [1, 1, 5, 1]
    assert writer.busy_time == 0


def test_a_fault_is_told_and_every_message_is_accounted_for(tmp_path, monkeypatch):
    writer = BackgroundWriter(BagWriter(tmp_path / 'bag', {}), room=1 << 30)
    writer.add_topic('/a', TYPE, [])
    for k in range(50):
        writer.write('/a', bytes(100), k)
    kept, told = threading.Event(), threading.Event()
    writer.submit(kept.set)
    assert kept.wait(PATIENCE)

    def broken(*_):
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    writer.submit(lambda: monkeypatch.setattr(storage.os, 'pwrite', broken))
    for k in range(50, 3000):
        writer.write('/a', bytes(1000), k)  # more than a chunk: it is written at once
    writer.submit(told.set)  # whoever waits for a step is answered
    assert told.wait(PATIENCE)
    with pytest.raises(StorageFault, match='stays readable'):
        writer.close()
    monkeypatch.undo()
    found = stored(tmp_path / 'bag')
    assert found == list(range(len(found)))
    assert len(found) + writer.lost_count + writer.dropped.total() == 3000
    assert isinstance(writer.fault, StorageFault)
    assert not writer.write('/a', b'', 3000)


def test_a_disk_that_is_nearly_full_gets_a_whole_bag(tmp_path, monkeypatch):
    writer = BackgroundWriter(BagWriter(tmp_path / 'bag', {}), room=1 << 30)
    writer.add_topic('/a', TYPE, [])
    for k in range(50):
        writer.write('/a', bytes(100), k)
    looked = threading.Event()

    def little(path):
        looked.set()
        return 1000

    monkeypatch.setattr(storage, 'free_space', little)
    assert looked.wait(PATIENCE)
    with pytest.raises(
        StorageFault, match=r'nearly full.*complete up to this time; free disk space'
    ):
        writer.close()
    assert read_bag(tmp_path / 'bag').is_complete
    assert stored(tmp_path / 'bag') == list(range(50))


def test_a_mistake_of_ours_is_not_swallowed(tmp_path):
    writer = BackgroundWriter(BagWriter(tmp_path / 'bag', {}), room=1 << 30)
    writer.write('/nobody/announced/this', b'', 0)
    with pytest.raises(KeyError):
        writer.close()
    assert read_bag(tmp_path / 'bag').is_complete


def test_messages_reach_the_disk_without_anybody_asking(tmp_path, monkeypatch):
    """What SIGKILL would leave: the writer flushes by itself, again and again."""
    written = threading.Semaphore(0)
    write = os.pwrite

    def pwrite(fd, data, offset):
        done = write(fd, data, offset)
        written.release()
        return done

    writer = BackgroundWriter(BagWriter(tmp_path / 'bag', {}), room=1 << 30)
    writer.add_topic('/a', TYPE, [])
    monkeypatch.setattr(storage.os, 'pwrite', pwrite)
    for k in range(3):
        assert writer.write('/a', bytes(10), k)
        while stored(tmp_path / 'bag') != list(range(k + 1)):
            assert written.acquire(timeout=PATIENCE)
    writer.close()


def test_a_disk_that_keeps_the_writer_busy_is_seen_and_forgotten(tmp_path, monkeypatch):
    writer, disk = stall(tmp_path / 'bag', monkeypatch, room=10_000)
    before = writer.busy_time
    assert writer.busy_time > before > 0.0
    disk.let.set()
    writer.close()
    assert writer.busy_time == 0.0
