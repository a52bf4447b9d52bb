# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Lockstep: steps, losses and health of nodes, and who holds a graph up."""

from dataclasses import dataclass

from hypothesis import given
from hypothesis import strategies as st
from lta_config.topics import load_topic_table
from lta_graph.health import find_stalling_roles, Health, HealthFact, HealthLevel
from lta_graph.lockstep import Inbox
import pytest

TABLE = load_topic_table()
START = TABLE.start_ns
MS = 1_000_000
LENGTH = 400 * MS  # of every stream: four light blocks


def nth(name: str, index: int) -> int:
    """Return the stamp of a periodic topic's message, counted from 0 [ns]."""
    return START + index * TABLE[name].period_ns


@dataclass(frozen=True)
class Reader:
    """A role, what it reads, and what it answers."""

    role: str
    topics: tuple[str, ...]
    trigger: str

    def inbox(self, lockstep: bool = True) -> Inbox:
        return Inbox(TABLE, self.role, list(self.topics), self.trigger, lockstep)

    def streams(self) -> dict[str, list[tuple[int, str]]]:
        """Return every topic's messages: stamp, and a text that stands for the message."""
        return {
            name: [
                (nth(name, k) if TABLE[name].stamped else 0, f'{name} {k}')
                # One more of the others: the last block is answered when it is complete.
                for k in range(LENGTH // TABLE[name].period_ns + (name != self.trigger))
            ]
            for name in self.topics
        }


# Whoever answers a topic; the vehicle begins by itself, and steps on with each command.
ROLES = [*sorted({row.source for row in TABLE.topics.values() if row.answers}), 'vehicle']
READERS = [
    Reader(role, tuple(TABLE.read_by(role)), TABLE.trigger_topic(role) or 'motors')
    for role in ROLES
]


def test_every_node_that_answers_is_tried():
    assert {reader.role for reader in READERS} == {
        'estimator', 'controller', 'demodulator', 'navigator', 'energy_monitor', 'vehicle',
    }  # fmt: skip
    assert all(reader.trigger in reader.topics for reader in READERS)


def expected(reader: Reader) -> list[tuple[int, dict[str, list[str]]]]:
    """Return all steps, each message sorted by itself to the first step that may know it."""
    streams = reader.streams()
    latency = TABLE[reader.trigger].latency_ns
    steps = [(stamp, {name: [] for name in reader.topics}) for stamp, _ in streams[reader.trigger]]
    for name in reader.topics:
        lag = 0 if name == reader.trigger else TABLE[name].subscribers[reader.role]
        for k, (_, message) in enumerate(streams[name]):
            known = nth(name, k) + TABLE[name].latency_ns + lag * TABLE.control_ns
            if name == reader.trigger:
                steps[k][1][name].append(message)
                continue
            later = [messages for stamp, messages in steps if stamp + latency >= known]
            if later:
                later[0][name].append(message)
    return steps


def take(inbox: Inbox) -> list[tuple[int, dict[str, list[str]]]]:
    steps = []
    while (step := inbox.pop()) is not None:
        steps.append((step.stamp_ns, dict(step.messages)))
    return steps


@st.composite
def mixed(draw):
    """Return a reader and its streams in some order that keeps the order within each topic."""
    reader = draw(st.sampled_from(READERS))
    streams = reader.streams()
    turns = [name for name in reader.topics for _ in streams[name]]
    draw(st.randoms(use_true_random=False)).shuffle(turns)
    ahead = draw(st.sampled_from([None, *reader.topics]))  # one topic may run far ahead
    turns.sort(key=lambda name: name != ahead)
    rest = {name: iter(messages) for name, messages in streams.items()}
    return reader, [(name, *next(rest[name])) for name in turns]


@given(mixed())
def test_every_interleaving_gives_the_same_steps(drawn):
    reader, messages = drawn
    inbox = reader.inbox()
    steps = []
    for message in messages:
        inbox.put(*message)
        steps += take(inbox)
    assert steps == expected(reader)
    assert not any(inbox.gaps.values())
    assert inbox.list_missing_topics() == []


@given(mixed())
def test_a_begun_step_waits_for_exactly_what_is_missing(drawn):
    reader, messages = drawn
    inbox = reader.inbox()
    put = dict.fromkeys(reader.topics, 0)
    done = 0
    for message in messages:
        inbox.put(*message)
        put[message[0]] += 1
        done += len(take(inbox))
        missing = []
        if put[reader.trigger] > done:
            now = nth(reader.trigger, done) + TABLE[reader.trigger].latency_ns
            for name in reader.topics:
                lag = TABLE[name].subscribers.get(reader.role, 0)
                if name != reader.trigger and put[name] < TABLE.count_due(name, now, lag):
                    missing.append(name)
            assert missing, 'a step with all its inputs must be answered'
        assert inbox.list_missing_topics() == missing


@given(mixed(), st.data())
def test_a_lost_message_is_counted_and_holds_the_graph(drawn, data):
    reader, messages = drawn
    stamped = [
        k
        for k, (name, stamp, _) in enumerate(messages)
        if TABLE[name].stamped and stamp < START + LENGTH - TABLE[name].period_ns
    ]
    lost = data.draw(st.sampled_from(stamped))
    name = messages[lost][0]
    inbox = reader.inbox()
    steps = []
    for k, message in enumerate(messages):
        if k != lost:
            inbox.put(*message)
            steps += take(inbox)
    assert inbox.gaps == {**dict.fromkeys(reader.topics, 0), name: 1}
    if name == reader.trigger:
        assert len(steps) == len(expected(reader)) - 1
    elif len(steps) < len(expected(reader)):
        assert inbox.list_missing_topics() == [name]


@given(mixed())
def test_in_real_time_nobody_waits_and_nothing_is_lost(drawn):
    reader, messages = drawn
    inbox = reader.inbox(lockstep=False)
    seen = {name: [] for name in reader.topics}
    since = {name: [] for name in reader.topics}
    for name, stamp, message in messages:
        inbox.put(name, stamp, message)
        since[name].append(message)
        steps = take(inbox)
        assert inbox.list_missing_topics() == []
        assert len(steps) == (name == reader.trigger)
        for step_stamp, taken in steps:
            assert step_stamp == stamp
            assert taken == since  # all that has come, oldest first
            since = {item: [] for item in reader.topics}
            for item, new in taken.items():
                seen[item] += new
    everything = {item: [text for _, text in stream] for item, stream in reader.streams().items()}
    assert {item: seen[item] + since[item] for item in seen} == everything


def test_in_real_time_only_the_newest_waits_for_a_trigger_that_has_stopped():
    inbox = Reader('estimator', ('imu', 'range', 'pressure', 'motors'), 'imu').inbox(False)
    for turn in range(5000):
        inbox.put('range', nth('range', turn), turn)
    inbox.put('imu', START, 'i0')
    # 2 s of 25 ms.
    assert inbox.pop().messages['range'] == list(range(4920, 5000))
    clock = Inbox(TABLE, 'users', ['wind', '/clock'], 'wind', lockstep=False)
    for turn in range(5000):
        clock.put('/clock', 0, turn)
    clock.put('wind', START, 'w0')
    assert clock.pop().messages['/clock'] == list(range(4900, 5000))


def test_in_lockstep_nothing_is_dropped_however_long_the_trigger_takes():
    inbox = Reader('estimator', ('imu', 'range'), 'imu').inbox()
    for turn in range(500):
        inbox.put('range', nth('range', turn), turn)
    taken = []
    for turn in range(1250):
        inbox.put('imu', nth('imu', turn), turn)
        taken += inbox.pop().messages['range']
    assert taken == list(range(500))


def test_a_step_by_hand():
    inbox = Reader('estimator', ('imu', 'range', 'pressure', 'motors'), 'imu').inbox()
    inbox.put('imu', START, 'i0')
    assert inbox.pop() is None
    assert inbox.list_missing_topics() == ['range', 'pressure']  # motors may come a period later
    inbox.put('pressure', START, 'p0')
    inbox.put('range', START, 'r0')
    step = inbox.pop()
    assert step.stamp_ns == START
    assert step.messages == {'imu': ['i0'], 'range': ['r0'], 'pressure': ['p0'], 'motors': []}
    assert (step.last_message('imu'), step.last_message('motors')) == ('i0', None)
    inbox.put('imu', START + 10 * MS, 'i1')
    assert inbox.list_missing_topics() == ['motors']
    inbox.put('motors', START, 'm0')
    assert inbox.pop().messages == {'imu': ['i1'], 'range': [], 'pressure': [], 'motors': ['m0']}
    assert inbox.pop() is None
    assert inbox.list_missing_topics() == []


def test_a_step_has_invalid_messages_but_not_among_the_valid():
    inbox = Inbox(TABLE, 'navigator', ['light/estimate', 'odom'], 'light/estimate', False)
    for k, valid in enumerate((True, False)):
        inbox.put('odom', nth('odom', k), f'odom {k}', valid)
    inbox.put('light/estimate', nth('light/estimate', 0), 'light 0')
    step = inbox.pop()
    assert step.messages == {'light/estimate': ['light 0'], 'odom': ['odom 0', 'odom 1']}
    assert step.valid == {'light/estimate': ['light 0'], 'odom': ['odom 0']}
    assert step.last_message('odom') == 'odom 1'
    # The newest is invalid: an older one must not pass for it
    assert step.last_valid('odom') is None
    assert step.last_valid('light/estimate') == 'light 0'
    inbox.put('light/estimate', nth('light/estimate', 1), 'light 1', valid=False)
    step = inbox.pop()
    assert (step.last_valid('light/estimate'), step.last_valid('odom')) == (None, None)


def test_several_lost_messages_are_all_counted():
    inbox = Reader('estimator', ('imu', 'range'), 'imu').inbox()
    inbox.put('range', START + 75 * MS, 'r3')
    inbox.put('imu', START + 20 * MS, 'i2')
    inbox.put('imu', START + 30 * MS, 'i3')
    assert inbox.gaps == {'imu': 2, 'range': 3}


@pytest.mark.parametrize('lockstep', [True, False])
def test_a_topic_without_rhythm_holds_nobody_up(lockstep):
    inbox = Inbox(TABLE, 'users', ['wind', '/diagnostics', '/clock'], 'wind', lockstep)
    inbox.put('/diagnostics', START + 3, 'd0')
    inbox.put('/clock', 0, 'c0')
    inbox.put('/diagnostics', START + 1, 'd1')
    inbox.put('wind', START, 'w0')
    step = inbox.pop()
    assert step.messages == {'wind': ['w0'], '/diagnostics': ['d0', 'd1'], '/clock': ['c0']}
    assert not any(inbox.gaps.values())


def test_health_keeps_the_newest_fact_of_each_task_and_tells_a_new_level():
    health = Health()
    assert (health.facts, health.changed) == ([], False)
    health.report('state', HealthLevel.OK, 'starting')
    health.report('inputs', HealthLevel.WARN, 'late', topic='imu', seconds=0.5)
    assert health.changed
    health.changed = False
    health.report('state', HealthLevel.OK, 'running')  # other words, same level: no news
    assert not health.changed
    health.report('inputs', HealthLevel.ERROR, 'none')
    assert health.changed
    assert health.facts == [
        HealthFact('state', HealthLevel.OK, 'running'),
        HealthFact('inputs', HealthLevel.ERROR, 'none'),
    ]


def test_figures_of_a_fact_are_text():
    health = Health()
    health.report('energy', HealthLevel.OK, 'fine', soc=0.5, cells=1)
    assert health.facts[0].values == {'soc': '0.5', 'cells': '1'}


def test_levels_are_those_of_ros():
    assert [(level.name, level.value) for level in HealthLevel] == [
        ('OK', 0),
        ('WARN', 1),
        ('ERROR', 2),
        ('STALE', 3),
    ]


def waiting(node, *suspects):
    return HealthFact(f'{node}: inputs', HealthLevel.ERROR, '', {'suspects': ','.join(suspects)})


def test_one_robot_by_hand():
    facts = [waiting('controller', 'estimator'), waiting('simulator', 'controller')]
    facts.append(waiting('energy_monitor', 'vehicle'))
    assert find_stalling_roles(facts) == ['estimator']
    assert find_stalling_roles([waiting('simulator', '')]) == []


def test_a_robot_that_waits_for_another_blames_neither_itself_nor_the_simulator():
    """The estimator of lta2 hangs; the simulator waits for duties, and all of lta1 for it."""
    facts = [
        waiting('lta2/controller', 'estimator'),
        waiting('simulator', '/lta2/controller'),
        waiting('lta1/estimator', 'vehicle'),
        waiting('lta1/controller', 'estimator'),
    ]
    assert find_stalling_roles(facts) == ['lta2/estimator']
    # The same name in the other robot is not excused by this one's waiting.
    assert find_stalling_roles([waiting('lta1/estimator', 'vehicle'), facts[0]]) == [
        'lta1/vehicle',
        'lta2/estimator',
    ]
