# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whatever comes on the light board's link, from the board or in its name, is survived."""

from types import SimpleNamespace

from hypothesis import given, settings
from hypothesis import strategies as st
from light_frames import build_frame, field_lengths, frame_bytes, KINDS
from lta_bridge.teensy._generated import mavlink
from lta_bridge.teensy.block_assembler import FrameParser
from lta_bridge.teensy.board_clock import ClockExchange
from lta_bridge.teensy.light_board import LightBoard, LightPeaks, OPEN_REQUESTS
from lta_bridge.teensy.port import LOYAL_NS, SenderFilter
from lta_bridge.teensy.reader import describe_health, LIGHT_BOARD_TASK
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table
from lta_emulation.teensy.emulated_board import COMPONENT, EmulatedBoard, SYSTEM
from lta_graph.health import HealthFact, HealthLevel
from lta_graph.ros.stamps import to_stamp
from lta_graph.ros.vehicle_messages import build_light_block_message
from lta_vlc.diodes import build_diode_array
from lta_vlc.lamp import LampFinder, LampPrior
from lta_vlc.messages import from_bearing, from_lamp, from_peaks
import numpy as np
import pytest
from rclpy.serialization import serialize_message
from std_msgs.msg import Header

LIGHT = load_topic_table().light
FINDER = LampFinder(build_diode_array(load_vehicle_file('gtmab').sensors.diodes))
BOOT = 1_700_000_000_000_000_000
EACH = 100_000_000  # ns between two looks
SAMPLES = np.random.default_rng(1).integers(0, 4096, (1000, 8)).astype(np.uint16)


class Linked:
    """A bridge's core and a good board, with room for what else comes between."""

    trouble, unplugged, strangers = '', 0, 0  # as its reader says

    def __init__(self, peaks=False):
        self.board, self.good = LightBoard(LIGHT, 8, peaks), EmulatedBoard(BOOT)
        self.now, self.peaks, self.got = BOOT + 2_000_000_000, peaks, []
        for _ in range(5):
            self.go_on(light=False)

    def go_on(self, spoilt=b'', light=True):
        """Live through a tenth of a second."""
        self.now += EACH
        self.hear(
            self.good.answer_timesync(
                self.board.compose_due_messages(self.now), self.now + 150_000
            )
        )
        self.hear(spoilt)
        if light:
            begun = self.now - EACH
            told = (
                self.good.encode_peaks(SAMPLES, 150.0, begun)
                if self.peaks
                else self.good.encode_light(SAMPLES)
            )
            self.hear(self.good.encode_status() + told)

    def hear(self, data):
        for came in self.board.receive_bytes(data, self.now):
            published(came)
            self.got.append(came)

    @property
    def fact(self):
        return describe_health(self, self.now, True)


def published(came):
    """Make the messages of what came, as the node does, down to their bytes."""
    stamp = to_stamp(came.stamp_ns)
    if not isinstance(came, LightPeaks):
        assert serialize_message(build_light_block_message(stamp, came.samples))
        return
    found = FINDER.find_lamp(came.peaks, 5.0, LampPrior())
    header = Header(stamp=stamp)
    for message in (
        from_bearing(header, found.towards),
        from_peaks(header, (came.peaks,), FINDER.diodes.axes),
        from_lamp(header, found.lamp),
    ):
        assert serialize_message(message)


def extremes(dtype):
    """Return values of a field at its ends, in between, and what is no number."""
    if dtype.kind == 'f':
        odd = [0.0, -0.0, np.nan, np.inf, -np.inf, 3.4e38, -3.4e38, 1e-45, 1.0, 150.0, 10e3]
        return st.sampled_from(odd)
    info = np.iinfo(dtype)
    return st.one_of(
        st.sampled_from([info.min, info.max, 0, 1, 8, 15]), st.integers(info.min, info.max)
    )


def frame_of(name):
    """Return any frame of a message, of any sender."""
    types = dict(zip(KINDS[name].fieldnames, KINDS[name].fieldtypes, strict=True))
    fields = {}
    for field, size in field_lengths(name).items():
        # A float of C has 32 bits, of numpy 64
        one = extremes(np.dtype(types[field].removesuffix('_t').replace('float', 'float32')))
        fields[field] = st.lists(one, min_size=size, max_size=size) if size else one
    source = st.sampled_from([SYSTEM, 0, 2, 255])
    return st.builds(
        lambda values, system, turn: build_frame(name, turn, system, COMPONENT, **values),
        st.fixed_dictionaries({}, optional=fields),
        source,
        st.integers(0, 255),
    )


resized = st.builds(
    lambda kind, payload: frame_bytes(kind.id, payload, kind.crc_extra),
    st.sampled_from([*KINDS.values()]),
    st.binary(max_size=255),
)
unknown = st.builds(
    frame_bytes,
    st.integers(0, 2**24 - 1).filter(lambda number: number not in mavlink.mavlink_map),
    st.binary(max_size=255),
    st.just(7),
)
hostile = st.one_of(*map(frame_of, KINDS), resized, unknown, st.binary(max_size=300))


@pytest.mark.parametrize('peaks', [False, True])
@given(st.lists(st.lists(hostile, max_size=4), max_size=8))
@settings(max_examples=15)  # each lives through six seconds and more
def test_any_frames_are_survived_and_the_board_s_light_comes_again(peaks, spoilt):
    link = Linked(peaks)
    for frames in spoilt:
        link.go_on(b''.join(frames))
    before = len(link.got)
    for _ in range(60):  # longer than another sender is believed, and an old clock
        link.go_on()
    assert len(link.got) - before >= 20
    assert link.fact.message == 'receiving light'
    for came in link.got:
        assert abs(came.stamp_ns - link.now) < 60_000_000_000


@pytest.mark.parametrize('message', KINDS)
@given(data=st.data())
@settings(max_examples=20)
def test_a_message_at_its_extremes_breaks_nothing(message, data):
    for peaks in (False, True):
        link = LightBoard(LIGHT, 8, peaks)
        frames = data.draw(st.lists(frame_of(message), min_size=1, max_size=3))
        for frame in frames:
            for came in link.receive_bytes(frame, BOOT):
                published(came)
        assert (link.framing.frames, link.framing.crc_errors) == (len(frames), 0)


counts = st.one_of(st.floats(0.0, 65535.0, width=32), extremes(np.dtype('<f4')))


@given(
    amplitude=st.lists(counts, min_size=16, max_size=16),
    noise=st.lists(counts, min_size=16, max_size=16),
    frequency=st.one_of(st.just(150.0), extremes(np.dtype('<f4'))),
)
def test_peaks_of_any_size_become_messages_or_are_counted(amplitude, noise, frequency):
    link = Linked(peaks=True)
    link.go_on()
    values = {'amplitude': amplitude, 'noise': noise, 'frequency': frequency, 'diodes': 8}
    time_usec = link.good.to_board_time(link.now) // 1000
    told = build_frame('LTA_LIGHT_PEAKS', time_usec=time_usec, window=LIGHT.samples, **values)
    before = len(link.got)
    link.hear(told)
    assert len(link.got) - before + link.board.unfit == 1
    for came in link.got[before:]:
        assert (came.peaks.amplitude >= 0.0).all()
        lamp = FINDER.find_lamp(came.peaks, 5.0, LampPrior()).lamp
        assert lamp is None or np.isfinite(lamp).all()


def test_light_of_another_system_is_left_out_and_counted():
    link = Linked()
    link.go_on()
    forged = [
        build_frame('LTA_LIGHT_BLOCK', k, 2, time_usec=2**64 - 1, diodes=8, rows=15)
        for k in range(50)
    ]
    for _ in range(20):
        link.go_on(b''.join(forged) + build_frame('LTA_LIGHT_STATUS', 0, 2, dialect=9))
    assert len(link.got) == 21
    assert (link.board.clock.restarts, link.board.blocks.restarts, link.board.fault) == (0, 0, '')
    assert link.fact.values['of_other_systems'] == str(20 * 51)


def test_who_shares_the_link_is_not_taken_for_the_board():
    """Heartbeats of a ground station neither keep a silent board alive nor come before it."""
    link, beat = Linked(), build_frame('HEARTBEAT', 0, 255, 190, type=6)
    link.board = LightBoard(LIGHT, 8)
    link.hear(beat)
    assert link.fact.message == 'nothing received yet'
    for _ in range(10):
        link.go_on(beat)
    assert link.fact.message == 'receiving light'
    for _ in range(10):
        link.now += EACH
        link.hear(beat)
    assert 'no data from the light board for 1.0 s' in link.fact.message


def test_a_flood_of_questions_is_answered_a_little_and_counted():
    link = Linked()
    asked = b''.join(build_frame('TIMESYNC', k, ts1=k + 1) for k in range(1000))
    link.hear(asked)
    answers = [
        f
        for f in FrameParser().parse_frames(link.board.compose_due_messages(link.now))
        if f.get_type() == 'TIMESYNC'
    ]
    assert len([f for f in answers if f.tc1]) == OPEN_REQUESTS
    assert link.fact.values['unanswered'] == str(1000 - OPEN_REQUESTS)


def test_what_cannot_be_used_is_counted_though_good_light_follows():
    link = Linked()
    link.go_on()
    bad = build_frame('LTA_LIGHT_BLOCK', diodes=3, rows=99)
    link.go_on(bad)
    assert link.board.fault == ''
    assert link.fact.values['unfit'] == '1'


@given(st.lists(st.tuples(st.sampled_from('ab'), st.integers(0, 3 * LOYAL_NS)), max_size=30))
def test_one_of_two_is_believed_at_a_time(words):
    one, now, last = SenderFilter(), 0, {}
    for who, later in words:
        now += later
        before = one.who
        believed = one.accept_sender(who, now)
        assert believed == (one.who == who)
        if before is not None and one.who != before:
            assert now - last[before] > LOYAL_NS
        if believed:
            last[who] = now


@pytest.mark.parametrize(
    ('now', 'believed'), [(LOYAL_NS, False), (LOYAL_NS + 1, True), (-1, True)]
)
def test_another_is_believed_after_two_seconds_and_where_the_clock_was_set_back(now, believed):
    assert LOYAL_NS == 2_000_000_000
    one = SenderFilter()
    assert one.accept_sender('a', 0)
    assert not one.accept_sender('b', 0)  # at the same time
    assert one.accept_sender('b', now) is believed
    assert (one.who, one.others) == ('b' if believed else 'a', 2 - believed)
    assert one.accept_sender('a', now) is not believed


def test_a_link_is_silent_after_half_a_second_and_its_own_trouble_comes_first():
    link = LightBoard(LIGHT, 8)
    reader = SimpleNamespace(board=link, trouble='', strangers=3, unplugged=2)

    def told(now, active=True):
        fact = describe_health(reader, now, active)
        return fact.level, fact.message

    assert describe_health(None, 0, True) == HealthFact(
        LIGHT_BOARD_TASK, HealthLevel.WARN, 'not configured'
    )
    assert told(10**9) == (HealthLevel.WARN, 'nothing received yet')
    link.heard_ns = 10**9
    assert told(10**9) == (
        HealthLevel.WARN,
        'the clock of the light board is not synchronized yet',
    )
    for turn in range(4):
        link.clock.add_exchange(ClockExchange(turn, turn, turn + 2_000))
    assert told(1_500_000_000) == (HealthLevel.OK, 'receiving light')
    assert told(1_500_000_000, active=False)[1] == 'receiving light, not publishing'
    assert told(1_500_000_001) == (HealthLevel.ERROR, 'no data from the light board for 0.5 s')
    assert list(link.receive_bytes(EmulatedBoard(0, dialect=9).encode_status(), 10**9)) == []
    level, message = told(10**9)
    assert (level, message) == (HealthLevel.ERROR, link.fault)
    assert 'version 9' in message
    reader.trouble = 'pulled'
    assert told(10**9) == (HealthLevel.ERROR, 'pulled')
    figures = describe_health(reader, 10**9, True).values
    assert (figures['of_other_senders'], figures['unplugged']) == ('3', '2')
    # 250 * 2 us + 20 us of deviation by each of four answers: half of 20.5 us.
    assert (figures['round_trip_ms'], figures['uncertainty_ms']) == ('0.002', '0.010')
