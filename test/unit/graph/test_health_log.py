# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is heard of the health of a graph, logged once, and taken from whoever publishes."""

from itertools import product

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lta_graph.health import (
    Health,
    HealthFact,
    HealthLevel,
    HealthLog,
    LINES_PER_STATUS,
    LOG_WINDOW,
    MAX_STATUSES,
)
from lta_graph.reach import describe_reach
from lta_graph.ros import listener
from lta_graph.ros.listener import (
    ALL_NODES_TIME,
    DiagnosticsListener,
    LOADING_TIME,
    NODE_SILENCE_TIME,
)
from lta_graph.ros.raw_subscriptions import match_profile
import pytest
from rclpy.qos import (
    DurabilityPolicy,
    qos_check_compatible,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
)

OK, WARN, ERROR = HealthLevel.OK, HealthLevel.WARN, HealthLevel.ERROR


def lines(log, now, *facts):
    """Return the lines for facts of one task, each a level and a message."""
    return log.update([HealthFact('link', *fact) for fact in facts], now)


def test_what_was_never_wrong_gets_no_line():
    log = HealthLog()
    assert lines(log, 0.0, (OK, 'connected'), (OK, 'still connected')) == []


@pytest.mark.parametrize('level', [WARN, ERROR, HealthLevel.STALE])
def test_a_fault_gets_one_line_and_its_end_another(level):
    log = HealthLog()
    assert lines(log, 0.0, (level, 'silent for 0.5 s')) == [(level, 'link: silent for 0.5 s')]
    for k in range(100):  # the same with other numbers, however long
        assert lines(log, 1.0 + k, (level, f'silent for {k + 1} s')) == []
    assert lines(log, 200.0, (OK, 'connected')) == [(OK, 'link: OK again, connected')]
    assert lines(log, 201.0, (OK, 'connected')) == []


def test_another_fault_of_the_same_task_gets_its_line_at_once():
    log = HealthLog()
    messages = [(WARN, 'holding'), (WARN, 'landing'), (ERROR, 'landing'), (ERROR, 'stopped')]
    assert lines(log, 0.0, *messages) == [(level, f'link: {text}') for level, text in messages]


def test_a_fault_between_two_reports_is_not_missed():
    """/diagnostics has only the newest status of a task."""
    health, log = Health(), HealthLog()
    health.report('link', ERROR, 'lost')
    health.report('link', OK, 'connected')
    heard = log.update(health.take_news(), 0.0)
    assert heard == [(ERROR, 'link: lost'), (OK, 'link: OK again, connected')]
    for fault in ('holding for 3 s', 'holding for 4 s', 'landing'):  # of one level
        health.report('link', WARN, fault)
    health.report('link', OK, 'connected')
    heard = log.update(health.take_news(), 0.05)
    assert [line.text for line in heard] == [
        'link: holding for 3 s', 'link: landing', 'link: OK again, connected',
    ]  # fmt: skip
    assert log.update(health.take_news(), 0.1) == []


def test_a_fault_that_flaps_is_counted_and_hides_no_other():
    log, heard = HealthLog(), []
    for k in range(100):  # ten times a second for ten seconds
        heard += lines(log, 0.1 * k, (OK, 'connected') if k % 2 else (WARN, 'weak'))
    assert len(heard) == 4
    assert lines(log, 9.95, (ERROR, 'lost')) == [(ERROR, 'link: lost')]
    assert lines(log, LOG_WINDOW + 0.1, (OK, 'connected')) == [
        (OK, 'link: OK again, connected (changed 96 more times in 10 s)')
    ]
    later = [
        line
        for k in range(600)  # for a minute more
        for line in lines(log, 11.0 + 0.1 * k, (OK, 'connected') if k % 2 else (WARN, 'weak'))
    ]
    assert len(later) <= 6
    assert lines(log, 90.0, (WARN, 'weak')) != []


def test_messages_that_quote_others_cannot_fill_the_log():
    log = HealthLog()
    heard = [
        line
        for k in range(1000)
        for line in lines(log, 0.001 * k, (WARN, 'of ' + 'x' * (k % 500)), (OK, 'fine'))
    ]
    assert len(heard) <= MAX_STATUSES * LINES_PER_STATUS
    (line,) = lines(HealthLog(), 0.0, (WARN, 'red\x1b[31m'))
    assert line.text.isprintable()


@pytest.fixture
def clock(monkeypatch):
    """Return a list whose only item is the time [s]."""
    now = [100.0]
    monkeypatch.setattr(listener.time, 'monotonic', lambda: now[0])
    return now


def said(*names):
    """Return what nodes say, written as 'ROBOT/NODE'."""
    return DiagnosticArray(
        status=[
            DiagnosticStatus(name=f'{name}: state', hardware_id=name.rpartition('/')[0])
            for name in names
        ]
    )


@pytest.mark.usefixtures('clock')
def test_of_several_robots_each_fact_has_its_robot_s_name():
    both, one = DiagnosticsListener('lta1', 'lta2', ''), DiagnosticsListener('lta2')
    for ears in (both, one):
        ears._on_diagnostics(
            said('lta1/estimator', 'lta2/estimator', 'recorder', 'lta3/estimator')
        )
    assert set(both.facts) == {
        'lta1/estimator: state',
        'lta2/estimator: state',
        'recorder: state',
    }
    assert both.find_pending_nodes(['lta1/estimator', 'lta2/estimator', 'recorder', 'other']) == [
        'other'
    ]
    assert set(one.facts) == {'estimator: state'}


def test_silence_means_nothing_before_all_have_spoken_and_could_speak_again(clock):
    ears = DiagnosticsListener('lta1', 'lta2')
    nodes = ['lta1/estimator', 'lta2/estimator']
    assert ears.find_silent_nodes(nodes) == []
    ears._on_diagnostics(said('lta1/estimator'))
    clock[0] += 3.0
    assert ears.find_silent_nodes(nodes) == []
    ears._on_diagnostics(said('lta2/estimator'))
    assert ears.find_silent_nodes(nodes) == []
    clock[0] += NODE_SILENCE_TIME + 0.01
    assert ears.find_silent_nodes(nodes) == nodes


def test_one_that_never_speaks_does_not_keep_silence_meaningless_for_ever(clock):
    ears = DiagnosticsListener('lta1')
    ears._on_diagnostics(said('lta1/estimator'))
    clock[0] += ALL_NODES_TIME + 0.01
    assert ears.find_silent_nodes(['estimator', 'theirs']) == []
    clock[0] += NODE_SILENCE_TIME + 0.01
    assert ears.find_silent_nodes(['estimator', 'theirs']) == ['estimator']
    ears._on_diagnostics(said('lta1/estimator'))
    assert ears.find_silent_nodes(['estimator', 'theirs']) == []
    clock[0] += LOADING_TIME
    assert ears.find_silent_nodes(['estimator', 'theirs'], required=False) == ['estimator']
    assert ears.find_silent_nodes(['theirs']) == ['theirs']


PROFILES = [
    QoSProfile(depth=3, reliability=reliability, durability=durability)
    for reliability, durability in product(
        (ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT),
        (DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE),
    )
]
BESIDE = [found for count in (1, 2) for found in product(PROFILES, repeat=count)]
LEAST = {'reliability': ReliabilityPolicy.BEST_EFFORT, 'durability': DurabilityPolicy.VOLATILE}


@pytest.mark.parametrize('asked', PROFILES)
@pytest.mark.parametrize(
    'publishers', [*product(PROFILES, repeat=1), *product(PROFILES, repeat=2)]
)
def test_no_publisher_is_incompatible_and_nothing_is_given_up_without_need(asked, publishers):
    found = match_profile(asked, publishers)
    for each in publishers:
        assert qos_check_compatible(each, found)[0] != QoSCompatibility.ERROR
    for policy, least in LEAST.items():
        given_up = getattr(found, policy) != getattr(asked, policy)
        assert given_up == (
            getattr(asked, policy) != least
            and any(getattr(each, policy) == least for each in publishers)
        )
    assert found.depth == asked.depth


def test_where_nobody_is_there_everything_is_asked_for():
    assert match_profile(PROFILES[0], []) == PROFILES[0]


RANGE, PEERS = 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_STATIC_PEERS'
OWN = {'FASTRTPS_DEFAULT_PROFILES_FILE': '/lta/config/fastdds/this_machine.xml'}


@pytest.mark.parametrize(
    ('environment', 'cause'),
    [
        ({}, f'{RANGE}=SUBNET'),  # the default of ROS 2
        ({RANGE: ''}, f'{RANGE}=SUBNET'),
        ({RANGE: 'SUBNET'}, f'{RANGE}=SUBNET'),
        ({RANGE: 'SYSTEM_DEFAULT'}, f'{RANGE}=SYSTEM_DEFAULT'),
        ({RANGE: 'LOCALHOST', PEERS: '192.0.2.7'}, f'{PEERS}=192.0.2.7'),
        ({RANGE: 'LOCALHOST'}, ''),
        ({RANGE: 'OFF'}, ''),
        ({RANGE: 'SYSTEM_DEFAULT', **OWN}, ''),
        ({RANGE: 'SUBNET', PEERS: '192.0.2.7', 'ROS_LOCALHOST_ONLY': '1'}, ''),
    ],
)
def test_an_open_graph_is_a_warning_with_its_cause(environment, cause):
    fact = describe_reach(environment)
    assert (fact.level == HealthLevel.WARN) == bool(cause)
    assert ('anyone on the network can command the drone' in fact.message) == bool(cause)
    assert f'({cause})' in fact.message or not cause
