# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Log time and losses by hand, and what nonsense does to them."""

from itertools import count
import struct

from hypothesis import given
from hypothesis import strategies as st
from lta_bridge.log_time_assigner import LARGEST_JUMP_NS, LogTimeAssigner, read_stamp
from lta_config.topics import load_topic_table
import pytest

TABLE = load_topic_table()
START, MS, S = TABLE.start_ns, 10**6, 10**9
EPOCH = 1_763_000_000 * S


def cdr(stamp, little=True):
    """Return the beginning of a serialised message."""
    order = '<' if little else '>'
    return bytes([0, little, 0, 0]) + struct.pack(order + 'iI', *divmod(stamp, S)) + bytes(8)


@given(st.integers(0, 2**31 * S - 1), st.booleans())
def test_stamp_is_read_in_either_order(stamp, little):
    assert read_stamp(cdr(stamp, little)) == stamp


def test_log_time_is_the_message_s_own_publication():
    books = LogTimeAssigner(TABLE, lockstep=True)
    heard = [
        ('imu', START, START),
        ('imu', START + 10 * MS, START + 10 * MS),
        ('range', START, START),  # taken late, and still dated by itself
        ('photodiodes', START, START + 100 * MS),  # out 100 ms after its first sample
        ('imu', START + 20 * MS, START + 20 * MS),
    ]
    assert [books.assign_log_time(name, cdr(stamp)) for name, stamp, _ in heard] == [
        when for _, _, when in heard
    ]
    assert (books.lost, books.wild, books.torn) == ({}, {}, {})
    assert books.counts == {'imu': 3, 'range': 1, 'photodiodes': 1}


def test_what_has_no_stamp_is_dated_by_its_turn_or_by_the_newest():
    exact, live = LogTimeAssigner(TABLE, lockstep=True), LogTimeAssigner(TABLE, lockstep=False)
    for books in (exact, live):
        books.assign_log_time('imu', cdr(START + 250 * MS))
    turns = [exact.assign_log_time('energy/reserve', bytes([0, 1, 0, 0, 1])) for _ in range(3)]
    assert turns == [START, START + 100 * MS, START + 200 * MS]
    assert live.assign_log_time('energy/reserve', bytes([0, 1, 0, 0, 1])) == START + 250 * MS
    assert exact.assign_log_time('/clock', cdr(0)) == START + 250 * MS  # no rhythm, no turn


def test_a_message_on_tf_is_dated_by_its_first_transform():
    """The number of transforms comes before it."""
    books = LogTimeAssigner(TABLE, lockstep=False)
    data = cdr(0)[:4] + struct.pack('<I', 1) + cdr(START + 250 * MS)[4:]
    assert books.assign_log_time('/tf', data) == START + 250 * MS
    assert books.assign_log_time('/tf', data[:15]) == START + 250 * MS
    assert books.torn == {'/tf': 1}


def test_what_is_published_once_is_dated_by_the_start_of_a_flight():
    exact, live = LogTimeAssigner(TABLE, lockstep=True), LogTimeAssigner(TABLE, lockstep=False)
    for books in (exact, live):
        books.assign_log_time('imu', cdr(START + 250 * MS))
    for name in ('/tf_static', 'scene', 'robot_description'):
        assert exact.assign_log_time(name, bytes(8)) == START
        assert live.assign_log_time(name, bytes(8)) == START + 250 * MS


def test_losses_are_counted_from_the_start_in_lockstep_alone():
    late = [START + k * 10 * MS for k in (3, 4, 6)]
    books = {lockstep: LogTimeAssigner(TABLE, lockstep) for lockstep in (True, False)}
    for stamp in late:
        for each in books.values():
            each.assign_log_time('imu', cdr(stamp))
    assert books[True].lost == {'imu': 3 + 1}
    assert books[False].lost == {'imu': 1}


@pytest.mark.parametrize('jump', [LARGEST_JUMP_NS + 1, 10**18])
@pytest.mark.parametrize('lockstep', [True, False])
def test_a_wild_stamp_moves_no_time_and_counts_as_itself(jump, lockstep):
    books = LogTimeAssigner(TABLE, lockstep)
    books.assign_log_time('imu', cdr(START))
    books.assign_log_time('odom', cdr(START))
    assert books.assign_log_time('odom', cdr(START + jump)) == START
    assert books.assign_log_time('imu', cdr(START + 10 * MS)) == START + 10 * MS
    assert books.assign_log_time('odom', cdr(START + 10 * MS)) == START + 10 * MS
    assert books.wild == {'odom': 1}
    assert books.lost == {}


def test_time_that_has_moved_on_for_all_is_believed_after_a_second():
    wall = count()
    books = LogTimeAssigner(TABLE, lockstep=False, clock=lambda: 0.01 * next(wall))
    books.assign_log_time('imu', cdr(START))
    times = [books.assign_log_time('imu', cdr(START + 60 * S + k * 10 * MS)) for k in range(102)]
    assert times[:99] == [START] * 99
    assert times[101] == START + 61 * S + 10 * MS
    assert books.lost['imu'] > 5900


def test_a_real_vehicle_has_the_time_of_the_wall_at_once():
    books = LogTimeAssigner(TABLE, lockstep=False)
    assert books.assign_log_time('imu', cdr(EPOCH)) == EPOCH
    assert (books.wild, books.lost) == ({}, {})


def test_a_stamp_from_the_past_is_no_loss_later():
    books = LogTimeAssigner(TABLE, lockstep=True)
    for stamp in (START, START + 10 * MS, 0, START + 20 * MS):
        books.assign_log_time('imu', cdr(stamp))
    assert books.lost == {}


@given(st.lists(st.tuples(st.sampled_from(sorted(TABLE.topics)), st.binary(max_size=20))))
def test_whatever_comes_has_a_log_time(messages):
    books = LogTimeAssigner(TABLE, lockstep=True)
    times = [books.assign_log_time(name, data) for name, data in messages]
    assert all(START <= when < 2**63 for when in times)
    assert sum(books.counts.values()) == len(messages)


def test_a_real_drone_is_dated_from_the_time_of_day():
    """What comes before any stamp, such as diagnostics, would else stretch the bag to 1970."""
    books = LogTimeAssigner(TABLE, lockstep=False, begun_ns=10**18)
    assert books.assign_log_time('/diagnostics', bytes(20)) == 10**18
