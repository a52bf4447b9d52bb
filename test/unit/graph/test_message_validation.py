# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is called a message that cannot be meant, and how much of it is told."""

import math

from geometry_msgs.msg import Vector3
from hypothesis import given
from hypothesis import strategies as st
from lta_config.topics import load_topic_table
from lta_graph.health import HealthLevel, LONGEST_REJECTION_REASON, RejectionCount
from lta_graph.ros.message_validation import (
    FAULT_FINDERS,
    find_fault,
    find_message_type,
    LARGEST_VALUE,
    MessageValidator,
    NUMERIC_FIELDS,
    STAMP_JUMP_NS,
)
from lta_graph.ros.stamps import to_stamp
from lta_msgs import msg as msgs
import pytest
from sensor_msgs.msg import Range

TABLE = load_topic_table()
IMU = find_message_type(TABLE['imu'])


def airspeed(forward):
    message = find_message_type(TABLE['airspeed'])()
    message.twist.twist.linear.x = forward
    return message


def test_an_empty_message_of_any_topic_can_be_judged():
    for row in TABLE.topics.values():
        assert isinstance(find_fault(find_message_type(row)()), str)


def test_every_field_that_is_looked_at_is_one():
    kinds = {row.type.split('/')[2]: find_message_type(row) for row in TABLE.topics.values()}
    for name, paths in NUMERIC_FIELDS.items():
        for path in paths:
            part = kinds[name]() if name in kinds else None
            for word in path.split('.') if part else ():
                part = getattr(part, word)
    assert FAULT_FINDERS.keys() <= kinds.keys()
    assert NUMERIC_FIELDS.keys() - {'Joy'} <= kinds.keys()


@given(
    st.floats(),
    st.sampled_from(['angular_velocity', 'linear_acceleration']),
    st.sampled_from('xyz'),
)
def test_one_number_of_six_is_enough(value, field, axis):
    message = IMU()
    setattr(getattr(message, field), axis, value)
    assert (find_fault(message) == '') == (abs(value) <= LARGEST_VALUE)


@pytest.mark.parametrize(
    ('message', 'words'),
    [
        (airspeed(0.5), ''),
        (airspeed(math.nan), 'twist.twist'),
        (airspeed(math.inf), 'twist.twist'),
        (Range(range=math.nan), 'not a number'),
        (Range(range=-math.inf), ''),
        (Range(range=3e38), 'implausibly large'),
    ],
)
def test_numbers_and_lengths(message, words):
    assert words in find_fault(message)
    assert bool(find_fault(message)) == bool(words)


def test_numbers_and_lengths_of_lta_msgs():
    axes = [Vector3(x=1.0), Vector3(y=1.0)]
    peaks = {'amplitude': [1.0, 2.0], 'snr': [1.0, 2.0], 'frequency': [1.0, 2.0]}
    for message, words in (
        (msgs.ActuatorDuty(name=['a'], duty=[0.5]), ''),
        (msgs.ActuatorDuty(name=['a'], duty=[0.1, 0.2]), '1 names, but 2 duties'),
        (msgs.ActuatorDuty(name=['a'], duty=[math.nan]), 'duty'),
        (msgs.LightBlock(diodes=2, counts=[1, 2, 3, 4]), ''),
        (msgs.LightBlock(diodes=2, counts=[1, 2, 3]), '3 counts, no multiple of its 2'),
        (msgs.LightBlock(diodes=0, counts=[1]), '1 counts, no multiple of its 0'),
        (msgs.LampPeaks(axis=axes, beacon=[msgs.BeaconPeaks(**peaks)]), ''),
        (
            msgs.LampPeaks(axis=axes[:1], beacon=[msgs.BeaconPeaks(**peaks)]),
            '1 diodes, but 2 values of amplitude',
        ),
        *(
            (
                msgs.LampPeaks(axis=axes, beacon=[msgs.BeaconPeaks(**peaks | {name: [1.0, odd]})]),
                '' if name == 'snr' else 'a beacon has a value that is not a number',
            )
            for name in peaks
            for odd in (math.nan, math.inf, 1e30)
        ),
        (msgs.LampPeaks(axis=[Vector3(x=math.nan)]), 'its axis has a value'),
    ):
        assert words in find_fault(message)
        assert bool(find_fault(message)) == bool(words)


def test_a_stamp_that_jumps_is_counted_where_stamps_are_looked_at():
    row = TABLE['imu']
    for looks in (True, False):
        sound = MessageValidator(stamps=looks)
        for at in (1, 2, 3 + 2 * STAMP_JUMP_NS, 4, 5):
            message = IMU()
            message.header.stamp = to_stamp(10**12 + at)
            sound.validate(row, 'imu', message)
        assert sound.unsound.count == (2 if looks else 0)
    assert MessageValidator(stamps=True).unsound.build_fact('messages').level == HealthLevel.OK


def test_whoever_sends_nonsense_does_not_decide_how_much_of_it_is_told():
    refused = RejectionCount()
    for _ in range(3):
        refused.add('x' * 10**6)
    fact = refused.build_fact('messages')
    assert fact.level == HealthLevel.WARN
    assert len(fact.message) < LONGEST_REJECTION_REASON + 100
    assert fact.values == {'count': '3'}


def test_invalid_content_is_told_and_a_jump_of_the_stamp_is_not_that():
    validator = MessageValidator(stamps=True)
    row, message = TABLE['imu'], IMU()
    assert validator.validate(row, 'imu', message)
    message.header.stamp = to_stamp(2 * STAMP_JUMP_NS)
    assert validator.validate(row, 'imu', message)
    message.angular_velocity.x = math.nan
    assert not validator.validate(row, 'imu', message)
    assert validator.unsound.count == 2
