"""The last seconds in memory: as long as asked for, within their memory, once a fault."""

from collections import Counter
import errno
import os

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_bridge.bag import build_offered_qos, storage, StorageFault
from lta_bridge.bag.background_writer import BackgroundWriter
from lta_bridge.bag.snapshot_buffer import GRAIN_NS, SnapshotBuffer
from lta_bridge.fault_watch import DiagnosticsEntry, FaultWatch
from lta_bridge.snapshots import SnapshotScheduler
from lta_config.errors import BadInput
from lta_data.bag.reader import read_bag
from lta_graph.health import HealthLevel
import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from waiting import PATIENCE

S = 10**9
TYPE = 'sensor_msgs/msg/Image'
FALSE = b'\0\1\0\0\0'


def memory_of(folder, span=5 * S, room=1 << 30):
    memory = SnapshotBuffer(folder, {'seed': '4'}, span, room)
    memory.add_topic('/a', TYPE, [build_offered_qos('reliable', 'volatile', 10)])
    return memory


def stored(folder):
    return [when for _, when, _ in read_bag(folder).iterate_messages()]


def test_the_last_seconds_are_a_bag_of_their_own(tmp_path):
    memory = memory_of(tmp_path / 'bag')
    sent = [(k * S // 10, bytes([0, 1, 0, 0, k % 256])) for k in range(1000)]
    for when, data in sent:
        memory.write('/a', data, when)
    assert list((tmp_path / 'bag').iterdir()) == []
    path, count = memory.write_snapshot('asked for')
    assert path == tmp_path / 'bag' / 'snapshot_0'
    with AnyReader([path]) as reader:
        found = [(when, data) for _, when, data in reader.messages()]
        assert reader.message_count == len(found) == count
    assert found == sent[-count:]
    # Five seconds of 10 Hz, and whole chunks: as much again as two of them hold.
    assert 50 <= count <= 51 + 2 * (GRAIN_NS * 10 // S + 1)
    bag = read_bag(path)
    assert bag.is_complete
    assert bag.provenance == {'seed': '4', 'snapshot': 'asked for'}


def test_snapshots_overlap_and_stand_side_by_side(tmp_path):
    memory = memory_of(tmp_path)
    for k in range(100):
        memory.write('/a', FALSE, k * S // 10)
        if k in (70, 99):
            memory.write_snapshot(f'at {k}')
    first, second = (stored(tmp_path / f'snapshot_{n}') for n in range(2))
    assert (first[-1], second[-1]) == (70 * S // 10, 99 * S // 10)
    assert second[0] < first[-1]


@settings(max_examples=25)
@given(st.lists(st.tuples(st.integers(0, S), st.integers(1, 60_000)), min_size=1, max_size=80))
def test_memory_has_a_bound_and_what_is_kept_is_the_newest(tmp_path_factory, steps):
    room, noise, now = 200_000, np.random.default_rng(0), 0
    memory = memory_of(tmp_path_factory.mktemp('law') / 'bag', room=room)
    times = []
    for step, size in steps:
        now += step
        memory.write('/a', noise.bytes(size), now)
        times.append(now)
        assert memory.size <= room
    found = stored(memory.write_snapshot('').path)
    assert found == times[len(times) - len(found) :]
    assert memory.size <= room


def test_what_is_kept_for_those_who_come_late_is_never_forgotten(tmp_path):
    memory = memory_of(tmp_path / 'bag')
    memory.add_topic('/map', TYPE, [build_offered_qos('reliable', 'transient_local', 1)])
    memory.add_topic('/old', TYPE, [])
    for name in ('/map', '/map', '/old'):
        memory.write(name, FALSE, 7)
    for k in range(100):
        memory.write('/a', FALSE, k * S)
    path, _ = memory.write_snapshot('')
    counts = Counter(topic for topic, _, _ in read_bag(path).iterate_messages())
    assert (counts['/map'], counts['/old']) == (1, 0)
    assert counts['/a'] >= 5
    assert set(read_bag(path).topics) == {'/a', '/map', '/old'}


def test_a_full_disk_costs_a_snapshot_and_not_the_memory(tmp_path, monkeypatch):
    memory = memory_of(tmp_path / 'bag')
    memory.write('/a', FALSE, 1)
    writer = BackgroundWriter(memory, 1000)
    snapshots = SnapshotScheduler(memory, writer)
    assert snapshots.summarize()[:2] == (HealthLevel.OK, 'no snapshots yet')

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(storage.os, 'pwrite', full)
    saving = snapshots.request_snapshot()
    assert saving.done.wait(PATIENCE)
    assert saving.made is None
    assert 'The recording ends here; what was recorded so far stays readable' in saving.status_text
    assert snapshots.summarize()[0] == HealthLevel.WARN
    monkeypatch.undo()
    writer.write('/a', FALSE, 2)
    again = snapshots.request_snapshot()
    assert again.done.wait(PATIENCE)
    assert again.made.messages == 2
    assert again.status_text == f"The snapshot '{again.made.path}' has 2 messages."
    level, _, figures = snapshots.summarize()
    assert (level, figures['written'], figures['failed']) == (HealthLevel.OK, 1, 1)
    writer.close()


def test_a_nearly_full_disk_gets_a_whole_snapshot_of_what_still_fits(tmp_path, monkeypatch):
    memory, left = memory_of(tmp_path / 'bag'), iter([1 << 40] * 3)
    for k in range(100):
        memory.write('/a', FALSE, k * S // 10)
    monkeypatch.setattr(storage, 'free_space', lambda _: next(left, 0))
    with pytest.raises(StorageFault, match='complete up to this time'):
        memory.write_snapshot('')
    bag = read_bag(tmp_path / 'bag' / 'snapshot_0')
    assert bag.is_complete
    assert 0 < bag.topics['/a'].count < 50


def test_a_busy_folder_is_refused(tmp_path):
    (tmp_path / 'mine.txt').write_text('keep')
    with pytest.raises(BadInput, match='choose another folder'):
        memory_of(tmp_path)


def test_a_fault_is_told_once_until_it_is_over():
    watch = FaultWatch()
    watch.add_statuses(
        [DiagnosticsEntry('lta1', 'a: state', False), DiagnosticsEntry('lta1', 'b: state', True)]
    )
    assert watch.take_new_faults(100.0) == ['lta1/b: state']
    watch.add_statuses([DiagnosticsEntry('lta1', 'b: state', True)])
    assert watch.take_new_faults(120.0) == []
    watch.add_statuses([DiagnosticsEntry('lta1', 'b: state', False)])
    watch.add_statuses([DiagnosticsEntry('lta1', 'b: state', True)])
    assert watch.take_new_faults(120.0) == ['lta1/b: state']


def test_whoever_waits_for_a_vehicle_whose_flight_is_over_has_no_fault():
    watch = FaultWatch()
    waits = DiagnosticsEntry('lta1', 'controller: inputs', True)
    watch.add_statuses([waits._replace(robot='lta2')])
    assert watch.take_new_faults(0.0) == ['lta2/controller: inputs']
    watch.add_statuses([DiagnosticsEntry('lta1', 'simulator: flight', False, over=True), waits])
    assert watch.take_new_faults(10.0) == []
    # Another robot's flight goes on, and so does what else can fail.
    watch.add_statuses(
        [waits._replace(robot='lta3'), DiagnosticsEntry('lta1', 'recorder: recording', True)]
    )
    assert watch.take_new_faults(20.0) == ['lta3/controller: inputs', 'lta1/recorder: recording']


def test_faults_that_come_together_wait_for_the_rest_to_end_and_count_as_one():
    watch = FaultWatch()
    watch.add_statuses([DiagnosticsEntry('', 'a', True)])
    assert watch.take_new_faults(0.0) == ['a']
    watch.add_statuses([DiagnosticsEntry('', 'b', True), DiagnosticsEntry('', 'c', True)])
    watch.add_statuses([DiagnosticsEntry('', 'b', False), DiagnosticsEntry('', 'c', True)])
    watch.add_statuses([DiagnosticsEntry('', 'b', True)])
    assert watch.take_new_faults(9.9) == []
    assert watch.take_new_faults(10.0) == ['b', 'c']
    assert watch.take_new_faults(20.0) == []


def test_a_fault_in_the_diagnostics_is_saved_with_its_name(tmp_path):
    memory = memory_of(tmp_path / 'bag')
    writer = BackgroundWriter(memory, 1000)
    snapshots = SnapshotScheduler(memory, writer)
    writer.write('/a', FALSE, 5)
    snapshots.add_statuses([DiagnosticsEntry('lta1', 'motors', False)], 1.0)
    snapshots.add_statuses(
        [DiagnosticsEntry('lta1', 'motors', True), DiagnosticsEntry('lta1', 'light', True)], 2.0
    )
    snapshots.add_statuses([DiagnosticsEntry('lta1', 'motors', True)], 22.0)
    writer.close()
    (path,) = (tmp_path / 'bag').iterdir()
    assert read_bag(path).provenance['snapshot'] == 'lta1/motors; lta1/light'
    assert stored(path) == [5]


@pytest.mark.parametrize(
    ('heard', 'why'),
    [
        ([DiagnosticsEntry('lta1', 'simulator: flight', False, over=True)], None),
        ([], 'the recorder stopped before the flight was over'),
        (
            [DiagnosticsEntry('lta2', 'simulator: flight', False, over=True)],
            'the recorder stopped before the flight was over',
        ),
    ],
)
def test_whoever_is_stopped_before_the_end_keeps_the_last_seconds(tmp_path, heard, why):
    memory = memory_of(tmp_path / 'bag')
    snapshots = SnapshotScheduler(memory, writer := BackgroundWriter(memory, 1000))
    assert snapshots.save_remaining(['lta1']) is None  # there is nothing to keep
    memory.write('/a', FALSE, 5)
    snapshots.add_statuses(heard, 1.0)
    snapshots.save_remaining(['lta1'])
    writer.close()
    told = [read_bag(path).provenance['snapshot'] for path in (tmp_path / 'bag').iterdir()]
    assert told == ([why] if why else [])


def test_a_fault_that_waits_is_saved_at_the_end(tmp_path):
    memory = memory_of(tmp_path / 'bag')
    snapshots = SnapshotScheduler(memory, writer := BackgroundWriter(memory, 1000))
    memory.write('/a', FALSE, 5)
    over = DiagnosticsEntry('lta1', 'simulator: flight', False, over=True)
    snapshots.add_statuses([over, DiagnosticsEntry('lta1', 'a: state', True)], 1.0)
    snapshots.add_statuses([DiagnosticsEntry('lta1', 'b: state', True)], 2.0)
    saving = snapshots.save_remaining(['lta1'])
    writer.close()
    assert saving.status_text == f"The snapshot '{tmp_path}/bag/snapshot_1' has 1 messages."
    assert read_bag(tmp_path / 'bag/snapshot_1').provenance['snapshot'] == 'lta1/b: state'


def test_what_the_disk_refuses_for_good_is_a_fault_of_the_disk(tmp_path, monkeypatch):
    memory = memory_of(tmp_path / 'bag')
    memory.write('/a', FALSE, 1)

    def full(*_):
        raise OSError(errno.EDQUOT, os.strerror(errno.EDQUOT))

    monkeypatch.setattr(storage.os, 'pwrite', full)
    with pytest.raises(StorageFault):
        memory.write_snapshot('')
