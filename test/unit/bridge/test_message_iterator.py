# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is played from a bag: whose topics, in which order, and which section."""

from itertools import pairwise
from types import SimpleNamespace

from lta_bag.metadata import build_offered_qos
from lta_bag.schemas import load_jazzy_types
from lta_bag.writer import BagWriter
from lta_bridge.playback import message_iterator
from lta_bridge.playback.answer_times import PendingAnswers
from lta_bridge.playback.message_iterator import LAST_ANSWER_TIME, MessageIterator, Playback
from lta_bridge.playback.recording import open_recording
from lta_config.errors import BadInput
from lta_config.limits import limit_memory
from lta_config.topics import load_topic_table
from mcap.writer import Writer
import pytest
from rosbags.highlevel import AnyReader

TABLE = load_topic_table()
MS = 1_000_000
QOS = [build_offered_qos('reliable', 'volatile', 10)]
TYPES = load_jazzy_types()


def message(name, stamp_ns):
    """Return a message of a topic with a stamp, as bytes."""
    kind = TABLE[name].type
    time = TYPES.types['builtin_interfaces/msg/Time'](*divmod(stamp_ns, 10**9))
    header = TYPES.types['std_msgs/msg/Header'](stamp=time, frame_id='x')
    if kind == 'std_msgs/msg/Bool':
        return bytes(TYPES.serialize_cdr(TYPES.types[kind](data=True), kind))
    if kind == 'sensor_msgs/msg/FluidPressure':
        made = TYPES.types[kind](header=header, fluid_pressure=1e5, variance=0.5)
    else:
        made = TYPES.types[kind](header=header, illuminance=7.0, variance=0.5)
    return bytes(TYPES.serialize_cdr(made, kind))


def bag(folder, rows, provenance=None):
    """Write (absolute topic, name in the table, stamp, log time) as a bag."""
    with BagWriter(folder, provenance or {}) as writer:
        for full, name in dict.fromkeys((row[0], row[1]) for row in rows):
            writer.add_topic(full, TABLE[name].type, QOS)
        for full, name, stamp, log in rows:
            writer.write(full, message(name, stamp), log)
    return folder


def regular(count=5, robot='/lta1/', start=TABLE.start_ns, log=0):
    """Return rows of pressure every 20 ms and light every 100 ms, last first in the file."""
    rows = [(f'{robot}pressure', 'pressure', start + 20 * k * MS) for k in range(5 * count)]
    rows += [(f'{robot}illuminance', 'illuminance', start + 100 * k * MS) for k in range(count)]
    return [(*row, row[2] + log) for row in reversed(rows)]


def reel(path, **options):
    recording = open_recording(path, '', TABLE)
    return MessageIterator(recording, recording.topics, **options)


def taken(found):
    items = []
    while found.next_ns is not None:
        items.append(found.pop_message())
    return items


def test_messages_come_by_their_time_and_byte_for_byte(tmp_path):
    path = bag(tmp_path / 'bag', regular())
    items = taken(reel(path))
    assert [a.time_ns <= b.time_ns for a, b in pairwise(items)] == [True] * 29
    with AnyReader([path]) as reader:
        theirs = [(c.topic, t, bytes(data)) for c, t, data in reader.messages()]
    assert sorted((f'/lta1/{i.topic}', i.time_ns, i.data) for i in items) == sorted(theirs)


def test_a_section_begins_and_ends_by_the_bag_s_clock(tmp_path):
    path = bag(tmp_path / 'bag', regular())
    items = taken(reel(path, start=0.1, end=0.2))
    first = TABLE.start_ns
    assert [i.time_ns - first for i in items if i.topic == 'pressure'] == [
        k * MS for k in (100, 120, 140, 160, 180, 200)
    ]
    with pytest.raises(BadInput, match='no message later than 9 s, the start of the playback'):
        reel(path, start=9.0)
    with pytest.raises(BadInput, match='1 s after the first message, before its start at 2'):
        reel(path, start=2.0, end=1.0)


@pytest.fixture
def wall(monkeypatch):
    """Return a clock that a test sets [s]."""
    clock = SimpleNamespace(now=100.0)
    fake = SimpleNamespace(monotonic=lambda: clock.now)
    monkeypatch.setattr(message_iterator, 'time', fake)
    return clock


def test_in_real_time_messages_come_at_their_rate_and_the_end_waits_for_answers(tmp_path, wall):
    section = reel(bag(tmp_path / 'bag', regular()))
    playback = Playback(section, PendingAnswers({'odom': ()}), 2.0)
    assert not list(playback.iterate_due())  # not begun
    playback.begin()
    wall.now += 0.1  # 0.2 s of the bag: 11 pressures and 3 of light
    assert len(list(playback.iterate_due())) == 14
    assert playback.bag_time_ns() == section.begin_ns + 200 * MS
    wall.now += 10.0
    assert len(list(playback.iterate_due())) == 16
    assert playback.ended == ''
    wall.now += 0.9 * LAST_ANSWER_TIME
    assert playback.receive_answer('odom') is None
    wall.now += 0.9 * LAST_ANSWER_TIME
    assert (list(playback.iterate_due()), playback.ended) == ([], '')
    wall.now += 0.2 * LAST_ANSWER_TIME
    assert (list(playback.iterate_due()), playback.ended) == ([], 'played')
    figures = playback.summarize(running=False)
    assert (figures['outcome'], figures['messages'], figures['answers']) == ('played', '30', '1')


def test_in_lockstep_an_answer_that_is_overdue_ends_the_replay(tmp_path, wall):
    section = reel(bag(tmp_path / 'bag', regular()))
    playback = Playback(section, PendingAnswers({'odom': [section.begin_ns]}), None)
    playback.end_unanswered(1.0)
    assert playback.ended == ''  # not begun
    playback.begin()
    assert len(list(playback.iterate_due())) == 30  # all within the largest lag
    wall.now += 0.9
    playback.end_unanswered(1.0)
    assert (playback.ended, playback.summarize(running=True)['unanswered']) == ('', '1')
    assert playback.receive_answer('odom') == section.begin_ns
    wall.now += 0.9
    playback.end_unanswered(1.0)
    assert playback.ended == ''
    wall.now += 0.1
    playback.end_unanswered(1.0)
    assert playback.ended == 'unanswered'


def test_a_bag_of_others_without_namespace_and_on_another_clock_is_played_by_its_stamps(tmp_path):
    rows = regular(robot='/', start=7 * 10**9, log=1_700_000_000 * 10**9)
    recording = open_recording(bag(tmp_path / 'bag', rows), '', TABLE)
    assert (recording.robot, recording.topics) == ('', {'pressure', 'illuminance'})
    items = taken(MessageIterator(recording, recording.topics))
    assert (items[0].time_ns, items[-1].time_ns) == (7 * 10**9, 7 * 10**9 + 480 * MS)


def test_of_several_robots_one_must_be_named(tmp_path):
    rows = regular() + [(f'/lta2/{row[1]}', *row[1:]) for row in regular(2)]
    path = bag(tmp_path / 'bag', rows, {'robots': 'lta1 lta2', 'lta2/seed': '7', 'scenario': 'x'})
    with pytest.raises(BadInput, match=r'has several robots \(lta1, lta2\)'):
        open_recording(path, '', TABLE)
    with pytest.raises(BadInput, match="Unknown robot 'lta3'"):
        open_recording(path, 'lta3', TABLE)
    assert open_recording(path, '', TABLE, own='lta1').robot == 'lta1'
    recording = open_recording(path, 'lta2', TABLE, own='lta1')
    assert len(taken(MessageIterator(recording, recording.topics))) == 12
    assert recording.provenance == {'scenario': 'x', 'seed': '7'}


def test_a_recording_that_was_cut_short_is_refused_with_the_remedy(tmp_path):
    """A killed recorder leaves whole chunks without an index, and half a record behind them."""
    file = bag(tmp_path / 'bag', regular()) / 'bag_0.mcap'
    for cut in (-8, -400):
        file.write_bytes(file.read_bytes()[:cut])
        with pytest.raises(BadInput, match=r'unfinished \(.+\); copy it with `lta import`'):
            open_recording(tmp_path / 'bag', '', TABLE)


def test_a_file_that_was_only_just_begun_is_passed_over(tmp_path):
    path = bag(tmp_path / 'bag', regular())
    expected = taken(reel(path))
    (path / 'bag_1.mcap').touch()
    assert taken(reel(path)) == expected


def test_a_topic_of_another_type_is_left_out_and_said(tmp_path):
    path = bag(tmp_path / 'bag', [*regular(), ('/lta1/range', 'pressure', 10**9, 10**9)])
    recording = open_recording(path, '', TABLE)
    assert recording.topics == {'pressure', 'illuminance'}
    assert recording.strange == (
        "the topic '/lta1/range' is not played, because its type is "
        "'sensor_msgs/msg/FluidPressure' instead of 'sensor_msgs/msg/Range'",
    )


def test_what_cannot_be_played_is_one_sentence(tmp_path):
    empty, text = tmp_path / 'empty', tmp_path / 'text.mcap'
    empty.mkdir()
    text.write_text('no bag')
    other = tmp_path / 'other.mcap'
    with other.open('wb') as stream:
        writer = Writer(stream)
        writer.start()
        writer.finish()
    for path, words in (
        (tmp_path / 'none', 'does not exist'),
        (empty, 'contains no MCAP recording'),
        (text, 'is not an MCAP recording'),
        (other, 'has none of the topics listed in docs/topics.md'),
    ):
        with pytest.raises(BadInput, match=words):
            open_recording(path, '', TABLE)
    lone = bag(tmp_path / 'lone', [('/lta1/pressure', 'pressure', 10**9, 10**9)])
    with pytest.raises(BadInput, match='has no message on the topics imu'):
        MessageIterator(open_recording(lone, '', TABLE), ['imu'])


def test_a_chunk_that_unpacks_to_more_than_there_is_is_one_sentence(tmp_path, monkeypatch):
    """Of zeros, which pack to a thousandth: the library makes room for all that it says it is."""
    path = tmp_path / 'bomb.mcap'
    with path.open('wb') as stream:
        writer = Writer(stream, chunk_size=1 << 30)
        writer.start('ros2')
        schema = writer.register_schema('std_msgs/msg/Bool', 'ros2msg', b'bool data')
        channel = writer.register_channel('/lta1/energy/reserve', 'cdr', schema)
        writer.add_message(channel, 0, bytes(300 << 20), 0)
        writer.finish()
    monkeypatch.setattr('lta_config.limits.READER_MEMORY', 100 << 20)

    def play():
        found = open_recording(path, '', TABLE)
        list(found.iterate_messages(found.topics))

    with pytest.raises(BadInput, match='a chunk needs more than'), limit_memory():
        play()
