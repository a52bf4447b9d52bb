# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What discovery tells of publishers, as a bag tells it."""

from lta_bridge.bag import build_offered_qos
from lta_bridge.messages import to_offered_qos
from rclpy.duration import Duration, Infinite
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
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
