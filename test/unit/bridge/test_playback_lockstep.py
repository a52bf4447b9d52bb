# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A replay in lockstep cannot stand still, and repeats itself, whatever the recording lacks.

The whole graph as inboxes, without DDS: messages of a topic keep their order, topics are mixed at
random, and every node answers each trigger with one message a topic, as the real ones do.
"""

from dataclasses import dataclass, field
import random
import struct

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_bridge.playback.answer_times import (
    compute_answer_times,
    compute_due_times,
    NEVER_NS,
    PendingAnswers,
)
from lta_bridge.playback.node_selection import (
    list_replayable_roles,
    list_supporting_roles,
    select_nodes,
)
from lta_bridge.playback.recording import RecordedMessage
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_graph.lockstep import Inbox, RecordedSchedule
import pytest

TABLE = load_topic_table()
START, MS = TABLE.start_ns, 1_000_000
LENGTH = 500 * MS
AHEAD = 200 * MS


def stamped(stamp_ns):
    return b'\0\1\0\0' + struct.pack('<iI', *divmod(stamp_ns, 10**9))


def whole(topics, start=START):
    """Return a recording of some topics as the table has them, in order of time."""
    found = []
    for name in topics:
        row = TABLE[name]
        for k in range((LENGTH - row.latency_ns) // row.period_ns + 1):
            stamp = start + k * row.period_ns
            data = stamped(stamp) if row.stamped else b'\0\1\0\0\0'
            found.append(RecordedMessage(name, stamp + row.latency_ns, data))
    return sorted(found, key=lambda item: item.time_ns)


@dataclass
class Node:
    """A role with its inbox, and what it has been given so far."""

    role: str
    inbox: Inbox
    steps: list = field(default_factory=list)


def graph(cast, told):
    nodes = []
    for role in cast.nodes:
        trigger = TABLE.trigger_topic(role)
        inputs = list(dict.fromkeys((*TABLE.read_by(role), trigger)))
        nodes.append(Node(role, Inbox(TABLE, role, inputs, trigger, True, replayed=True)))
        nodes[-1].inbox.turns = RecordedSchedule(TABLE, told)
    return nodes


def played(messages, cast, seed):
    """Play a recording into a graph with the wire's delays; return every node's steps."""
    chance = random.Random(seed)
    times = compute_due_times(messages, TABLE)
    answers = compute_answer_times(times, TABLE, cast)
    told = {name: each.due for name, each in (times | answers).items()}
    owed = PendingAnswers({name: each.due for name, each in answers.items()})
    nodes, reel = graph(cast, told), list(messages)
    wires = {}  # (node, topic): messages on the way

    def send(name, stamp, what):
        for number, node in enumerate(nodes):
            if node.role in TABLE[name].subscribers:
                wires.setdefault((number, name), []).append((stamp, what))

    while True:
        while reel and reel[0].time_ns <= owed.latest_play_time(AHEAD):
            item = reel.pop(0)
            row = TABLE[item.topic]
            stamp = struct.unpack('<iI', item.data[4:12]) if row.stamped else (0, 0)
            send(item.topic, stamp[0] * 10**9 + stamp[1], item.data)
        if not wires:
            break
        number, name = key = chance.choice(sorted(wires))
        stamp, what = wires[key].pop(0)
        if not wires[key]:
            del wires[key]
        node = nodes[number]
        node.inbox.put(name, stamp, what)
        while (step := node.inbox.pop()) is not None:
            turn = len(node.steps)
            node.steps.append((step.stamp_ns, {k: tuple(v) for k, v in step.messages.items()}))
            for out in (name for name in cast.answers if TABLE[name].source == node.role):
                owed.register_answer(out)
                send(out, step.stamp_ns, (out, turn))
    return {node.role: node.steps for node in nodes}, owed, reel


@st.composite
def recordings(draw):
    """Return a cast, and a recording with gaps, jitter, late logs, jumps and missing topics."""
    again = tuple(
        draw(st.lists(st.sampled_from(list_replayable_roles(TABLE)), min_size=1, unique=True))
    )
    cast = select_nodes(TABLE, again, list_supporting_roles(TABLE, again))
    start = draw(st.sampled_from([START, START + 5 * MS, 3, 1_700_000_000 * 10**9]))
    missing = draw(st.sets(st.sampled_from(cast.played), max_size=2))
    chance = random.Random(draw(st.integers(0, 10**6)))
    lost = draw(st.sampled_from([0.0, 0.02, 0.5]))
    jitter = draw(st.sampled_from([0, MS, 30 * MS]))
    late = draw(st.sampled_from([0, 5 * MS, 400 * MS]))
    jump = draw(st.sampled_from([0, -200 * MS, 10**12]))
    found = []
    for item in whole([name for name in cast.played if name not in missing], start):
        if chance.random() < lost:
            continue
        moved = item.time_ns + chance.randint(0, late)
        data = item.data
        if TABLE[item.topic].stamped:
            seconds, rest = struct.unpack('<iI', data[4:12])
            stamp = seconds * 10**9 + rest + chance.randint(0, jitter)
            if jump and item.time_ns > start + LENGTH // 2:
                stamp = max(0, stamp + jump)
            data = stamped(stamp % (2**31 * 10**9))
        found.append(RecordedMessage(item.topic, moved, data))
    return cast, sorted(found, key=lambda item: item.time_ns)


@settings(max_examples=60)
@given(recordings(), st.integers(0, 1000))
def test_no_recording_keeps_a_replay_waiting_and_all_is_answered_once(drawn, seed):
    cast, messages = drawn
    steps, owed, left = played(messages, cast, seed)
    assert left == []
    assert owed.total_pending == 0
    assert owed.oldest_due() == NEVER_NS
    for role in cast.nodes:
        trigger = TABLE.trigger_topic(role)
        if trigger in cast.played:
            assert len(steps[role]) == sum(item.topic == trigger for item in messages)
        else:
            assert len(steps[role]) == owed.come[trigger]


@settings(max_examples=40)
@given(recordings(), st.integers(0, 1000), st.integers(0, 1000))
def test_a_replay_gives_the_same_steps_in_every_order_of_arrival(drawn, one, other):
    cast, messages = drawn
    assert played(messages, cast, one)[0] == played(messages, cast, other)[0]


@settings(max_examples=20)
@given(st.integers(0, 1000))
def test_a_whole_recording_is_answered_as_the_table_says(seed):
    """The flight's own rule, which counts periods, gives the same steps."""
    cast = select_nodes(TABLE, [], [])
    messages = whole(cast.played)
    steps, _, _ = played(messages, cast, seed)
    for role in cast.nodes:
        trigger = TABLE.trigger_topic(role)
        for stamp, given_ in steps[role]:
            now = stamp + TABLE[trigger].latency_ns
            for name, found in given_.items():
                if name == trigger:
                    assert len(found) == 1
                    continue
                lag = TABLE[name].subscribers[role]
                before = TABLE.count_due(name, now - TABLE[trigger].period_ns, lag)
                before = before if stamp > START else 0
                assert len(found) == TABLE.count_due(name, now, lag) - before


def test_what_is_due_of_a_whole_recording_is_what_the_table_says():
    cast = select_nodes(TABLE, [], [])
    times = compute_due_times(whole(cast.played), TABLE)
    turns = RecordedSchedule(
        TABLE,
        {
            name: each.due
            for name, each in (times | compute_answer_times(times, TABLE, cast)).items()
        },
    )
    for name in (*cast.played, *cast.answers):
        for now in range(START - 20 * MS, START + LENGTH - 200 * MS, 5 * MS):
            for lag in (0, 1):
                assert turns.count_due(name, now, lag) == TABLE.count_due(name, now, lag), name


def test_nothing_is_handed_out_before_the_player_has_said_what_is_due():
    inbox = Inbox(TABLE, 'demodulator', ['photodiodes'], 'photodiodes', True, replayed=True)
    inbox.put('photodiodes', START, 'block')
    assert inbox.pop() is None
    inbox.turns = RecordedSchedule(TABLE, {})
    assert inbox.pop() is not None


def test_whoever_owes_the_oldest_answer_is_named():
    owed = PendingAnswers({'odom': [10, 20], 'motors': [10, 20]})
    assert owed.latest_play_time(5) == 15
    assert (owed.register_answer('odom'), owed.list_oldest_topics()) == (10, ['motors'])
    assert (owed.register_answer('motors'), owed.oldest_due()) == (10, 20)
    assert (owed.register_answer('odom'), owed.register_answer('motors')) == (20, 20)
    assert owed.register_answer('odom') is None  # more than was owed
    assert (owed.total, owed.total_pending, owed.latest_play_time(5)) == (4, 0, NEVER_NS)


def test_a_cast_is_every_topic_of_its_roles_and_refuses_what_cannot_be():
    cast = select_nodes(TABLE, ['navigator'], list_supporting_roles(TABLE, ['navigator']))
    assert set(list_supporting_roles(TABLE, ['navigator'])) == {
        'demodulator',
        'estimator',
        'energy_monitor',
    }
    assert cast.answers == ('setpoint/pose', 'setpoint/velocity', 'light/beacon')
    assert {'light/peaks', 'odom', 'energy/reserve', 'imu'} <= set(cast.played)
    assert 'motors' not in cast.played
    assert cast.find_missing_topics(TABLE, ['light/peaks', 'odom']) == [
        'airspeed', 'light/estimate', 'energy/status', 'energy/reserve',
    ]  # fmt: skip
    with pytest.raises(BadInput, match=r"^Unknown node 'simulator'"):
        select_nodes(TABLE, ['simulator'], [])
    with pytest.raises(BadInput, match=r"'navigator' cannot both run again and be played"):
        select_nodes(TABLE, ['navigator'], ['navigator'])
