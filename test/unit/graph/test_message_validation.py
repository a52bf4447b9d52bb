# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages as they come: what is counted as invalid, how old it is, what belongs together."""

import math
from types import SimpleNamespace

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Vector3, Vector3Stamped
from hypothesis import given
from hypothesis import strategies as st
from lta_config.topics import load_topic_table
from lta_graph.health import (
    CLOCK_TOLERANCE,
    HealthLevel,
    LONGEST_REJECTION_REASON,
    RejectionCount,
    stamp_age,
)
from lta_graph.ros.message_validation import (
    FAULT_FINDERS,
    find_fault,
    find_message_type,
    LARGEST_VALUE,
    MessageValidator,
    NUMERIC_FIELDS,
    STAMP_JUMP_NS,
)
from lta_graph.ros.stamps import MessagePairing, OLDEST_STAND_IN_NS, to_stamp
from lta_graph.ros.transforms import build_transform, from_odometry, from_start, prefix_frames
from lta_msgs import msg as msgs
from nav_msgs.msg import Odometry
import pytest
from scipy.spatial.transform import Rotation
from sensor_msgs.msg import Range
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

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


def stamped(*stamps_ns):
    return [SimpleNamespace(header=SimpleNamespace(stamp=to_stamp(at))) for at in stamps_ns]


def test_messages_meet_the_partner_with_their_stamp():
    pairing, messages, partners = MessagePairing(), stamped(10, 20, 30), stamped(10, 20, 30, 40)
    assert pairing.pair_messages(messages, partners) == [
        (at, message, partner)
        for at, message, partner in zip((10, 20, 30), messages, partners, strict=False)
    ]
    (later,) = stamped(40)
    assert pairing.pair_messages([later], []) == [(40, later, partners[3])]


def test_the_last_partner_stands_in_for_a_while():
    pairing, (first, second) = MessagePairing(), stamped(1_000_000_000, 1_010_000_000)
    assert pairing.pair_messages([first], []) == [(1_000_000_000, first, None)]
    (partner,) = stamped(1_010_000_000)
    assert pairing.pair_messages([second], [partner]) == [(1_010_000_000, second, partner)]
    near, far = stamped(1_010_000_000 + OLDEST_STAND_IN_NS, 1_010_000_001 + OLDEST_STAND_IN_NS)
    assert [found for _, _, found in pairing.pair_messages([near, far], [])] == [partner, None]


def test_partners_without_a_message_are_forgotten():
    pairing, (late,) = MessagePairing(), stamped(50)
    pairing.pair_messages(stamped(20), stamped(10, 20))
    (_, _, found), *_ = pairing.pair_messages(stamped(10), [late])
    assert found.header.stamp.nanosec == 20


NOW = 10**18


@pytest.mark.parametrize(
    ('ahead', 'expected'),
    [
        (-2.5, 2.5),
        (0.0, 0.0),
        (CLOCK_TOLERANCE - 0.01, 0.01 - CLOCK_TOLERANCE),
        (CLOCK_TOLERANCE + 0.01, math.inf),
        (3600.0, math.inf),
    ],
)
def test_the_far_future_is_infinitely_old(ahead, expected):
    assert stamp_age(NOW + round(1e9 * ahead), NOW) == pytest.approx(expected)


def test_what_never_came_is_infinitely_old():
    assert stamp_age(None, NOW) == math.inf


def test_the_frames_of_a_robot_have_its_prefix_once_and_the_map_is_common_to_all():
    message = build_transform(Time(sec=3), ('map', 'odom'), (1, 2, 3), (0, 0, 0, 1))
    odom = Odometry(child_frame_id='base_link')
    odom.header.frame_id, wind = 'odom', Vector3Stamped()
    for each in (TFMessage(transforms=[message]), odom, odom, wind, String()):
        prefix_frames('lta2/', each)
    assert (message.header.frame_id, message.child_frame_id) == ('map', 'lta2/odom')
    assert message.header.stamp.sec == 3
    assert (odom.header.frame_id, odom.child_frame_id) == ('lta2/odom', 'lta2/base_link')
    assert wind.header.frame_id == ''


def test_a_pose_becomes_the_transform_between_its_frames():
    odom = Odometry(child_frame_id='base_link')
    odom.header.frame_id, odom.header.stamp.sec = 'odom', 7
    odom.pose.pose.position.x, odom.pose.pose.position.z = 1.0, 3.0
    odom.pose.pose.orientation.w, odom.pose.pose.orientation.z = 0.6, 0.8
    (moved,) = from_odometry(odom).transforms
    assert (moved.header, moved.child_frame_id) == (odom.header, 'base_link')
    assert (moved.transform.translation.x, moved.transform.translation.z) == (1.0, 3.0)
    assert moved.transform.rotation == odom.pose.pose.orientation


def test_odom_is_on_the_floor_below_the_start_with_its_heading():
    half = math.radians(15.0)
    pose = (-2.5, 1.0, 0.4, 0.0, 0.0, math.sin(half), math.cos(half))
    (start,) = from_start(pose).transforms
    assert (start.header.frame_id, start.child_frame_id) == ('map', 'odom')
    place, turn = start.transform.translation, start.transform.rotation
    assert (place.x, place.y, place.z) == (-2.5, 1.0, 0.0)
    nose = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w]).apply([1.0, 0.0, 0.0])
    assert nose == pytest.approx([math.sqrt(0.75), 0.5, 0.0])
