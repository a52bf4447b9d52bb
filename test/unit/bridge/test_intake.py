# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a recorder takes in: names, times, losses and qualities of service."""

from collections import Counter
import struct

from lta_bag import build_offered_qos
from lta_bridge.intake import MessageIntake
from lta_bridge.messages import to_offered_qos
from lta_config.topics import load_topic_table
from lta_graph.health import HealthLevel
import pytest
from rclpy.duration import Duration, Infinite
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

TABLE = load_topic_table()
START, MS = TABLE.start_ns, 10**6


class Kept:
    """Stands in for the writer: keeps everything."""

    def __init__(self):
        self.messages = []
        self.dropped = Counter()
        self.queued_bytes = 12

    def write(self, topic, data, log_time_ns):
        self.messages.append((topic, data, log_time_ns))


def cdr(stamp):
    return bytes([0, 1, 0, 0]) + struct.pack('<iI', *divmod(stamp, 10**9)) + bytes(8)


def intake(*robots, lockstep=True):
    writer = Kept()
    return MessageIntake(TABLE, lockstep, robots, writer), writer


@pytest.mark.parametrize(
    ('robots', 'name', 'owner', 'covered'),
    [
        (('lta1',), '/lta1/odom', ('lta1', 'odom'), True),
        (('lta1',), '/lta1/light/peaks', ('lta1', 'light/peaks'), True),
        (('lta1',), '/lta10/odom', (None, '/lta10/odom'), False),
        (('lta1',), '/clock', (None, '/clock'), True),
        (('lta1',), '/rosout', (None, '/rosout'), True),
        (('a', 'b'), '/b/wind', ('b', 'wind'), True),
        (('a', 'b'), '/c/wind', (None, '/c/wind'), False),
        (('',), '/odom', ('', 'odom'), True),
        (('',), '/clock', (None, '/clock'), True),
    ],
)
def test_an_absolute_name_is_a_robot_s_or_everybody_s(robots, name, owner, covered):
    taking, _ = intake(*robots)
    assert taking.find_owner(name) == owner
    assert taking.covers_topic(name) == covered


def test_transforms_of_several_robots_have_their_own_times():
    taking, writer = intake('a', 'b')
    names = ('/a/imu', '/tf', '/tf_static')
    imu, moving, still = (taking.create_topic_callback(name) for name in names)
    moved = [bytes([0, 1, 0, 0, 1, 0, 0, 0]) + cdr(START + k * 10 * MS)[4:] for k in (0, 1, 0, 1)]
    imu(cdr(START + 500 * MS))
    for data in moved:
        moving(data)
    still(moved[0])
    times = [START + 500 * MS, START, START + 10 * MS, START, START + 10 * MS, START]
    assert [when for _, _, when in writer.messages] == times
    assert not [key for key in taking.summarize_recording({})[2] if key.startswith('/tf')]


def test_who_joins_late_dates_what_was_sent_once_by_the_first_stamp():
    """A bag must not reach back to the start of a flight that it did not record."""
    taking, writer = intake('a', lockstep=False)
    scene, imu = map(taking.create_topic_callback, ('/a/scene', '/a/imu'))
    scene(bytes(8))
    assert writer.messages == []
    late = START + 50_000 * MS
    imu(cdr(late))
    assert writer.messages == [('/a/scene', bytes(8), late), ('/a/imu', cdr(late), late)]
    scene(bytes(4))
    assert writer.messages[-1] == ('/a/scene', bytes(4), late)
    alone, written = intake('a', lockstep=False)
    alone.create_topic_callback('/a/scene')(bytes(8))
    alone.write_early_messages()  # at the end of the recording
    assert written.messages == [('/a/scene', bytes(8), START)]


def test_each_robot_has_its_time_and_what_is_of_all_the_newest():
    taking, writer = intake('a', 'b')
    take = {
        name: taking.create_topic_callback(name) for name in ('/a/odom', '/b/odom', '/b/extra')
    }
    clock = taking.create_topic_callback('/clock')
    for name, step in (('/a/odom', 0), ('/b/odom', 0), ('/b/odom', 1), ('/a/odom', 1)):
        take[name](cdr(START + step * 10 * MS))
    take['/b/odom'](cdr(START + 20 * MS))
    take['/b/extra'](b'')  # no row in the table: as new as what its robot has told
    clock(cdr(0))
    times = [when - START for *_, when in writer.messages]
    assert times == [0, 0, 10 * MS, 10 * MS, 20 * MS, 20 * MS, 20 * MS]


@pytest.mark.parametrize(('robots', 'name'), [(('lta1',), 'odom'), (('lta1', 'b'), '/lta1/odom')])
def test_what_is_missing_is_counted_by_topic_and_cause(robots, name):
    taking, writer = intake(*robots)
    take = taking.create_topic_callback('/lta1/odom')
    for step in (0, 1, 5):
        take(cdr(START + step * 10 * MS))
    assert taking.summarize_recording({})[:2] == (HealthLevel.WARN, '3 messages lost')
    writer.dropped['/lta1/odom'] += 7
    level, words, figures = taking.summarize_recording({'/lta1/odom': 2})
    assert level == HealthLevel.WARN
    assert words == '3 messages lost, 2 messages lost by the middleware, 7 messages dropped'
    assert figures == {
        'messages': 3,
        'waiting_bytes': 12,
        f'{name} lost': 3,
        f'{name} lost by the middleware': 2,
        f'{name} dropped': 7,
    }


def test_what_is_due_is_learnt_by_robot():
    taking, writer = intake('a', 'b', lockstep=False)
    take = [taking.create_topic_callback(f'/{who}/energy/reserve') for who in 'ab']
    taking.set_due_times('b', {'energy/reserve': [START + 7 * MS]})
    for each in take:
        each(bytes([0, 1, 0, 0, 1]))
    assert [when for *_, when in writer.messages] == [START, START + 7 * MS]


def test_a_tick_of_the_clock_that_the_next_one_replaced_is_not_a_loss():
    taking, _ = intake('lta1')
    level, words, figures = taking.summarize_recording({'/clock': 2})
    assert (level, words) == (HealthLevel.OK, 'recording')
    assert set(figures) == {'messages', 'waiting_bytes'}
    assert (
        taking.summarize_recording({'/clock': 2, '/lta1/odom': 1})[1]
        == '1 messages lost by the middleware'
    )


FOREVER = {'sec': 9223372036, 'nsec': 854775807}


def discovered(**changes):
    """Return a profile as Fast DDS tells it of a publisher: without history and depth."""
    return QoSProfile(
        **{
            'history': HistoryPolicy.UNKNOWN,
            'depth': 0,
            'reliability': ReliabilityPolicy.RELIABLE,
            'durability': DurabilityPolicy.VOLATILE,
            'liveliness': LivelinessPolicy.AUTOMATIC,
            'deadline': Infinite,
            'lifespan': Infinite,
            'liveliness_lease_duration': Infinite,
            **changes,
        }
    )


def test_a_publisher_that_keeps_to_the_table_has_its_history_and_depth():
    assert to_offered_qos([discovered()], QoSProfile(depth=7)) == [
        build_offered_qos('reliable', 'volatile', 7)
    ]


def test_one_that_does_not_is_told_as_it_was_found():
    weak = discovered(reliability=ReliabilityPolicy.BEST_EFFORT)
    (found,) = to_offered_qos([weak], QoSProfile(depth=7))
    assert found == {
        **build_offered_qos('best_effort', 'volatile', 0),
        'history': 'unknown',
    }
    assert to_offered_qos([weak], None) == [found]


def test_each_profile_is_told_once_and_limits_are_kept():
    short = discovered(lifespan=Duration(seconds=10, nanoseconds=5))
    found = to_offered_qos([discovered(), short, discovered()], QoSProfile(depth=7))
    assert [each['lifespan'] for each in found] == [FOREVER, {'sec': 10, 'nsec': 5}]
    assert {each['depth'] for each in found} == {7}


def test_where_nobody_is_there_the_table_speaks():
    expected = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    assert to_offered_qos([], expected) == [build_offered_qos('reliable', 'transient_local', 1)]
    assert to_offered_qos([]) == []
