# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Channels: each quantity by name and unit, derived ones by hand calculation."""

from lta_bag.schemas import load_jazzy_types
from lta_config.topics import load_topic_table
from lta_data.bag import open_flight
from lta_data.bag.channels import read_flight
from lta_data.bag.table import find_unit
import numpy as np
import pytest

from ...report_flight import header, make  # noqa: TID252 - `test` is Python's own

SECOND = 1_000_000_000


def message(topic, type_name, time, **fields):
    full = make(type_name, header=header(time), **fields)
    return f'/lta1/{topic}', type_name, full, SECOND + round(time * 1e9)


@pytest.fixture
def flight(record):
    sent = []
    for k in range(3):
        yaw = 3.0 + 0.1 * k  # across the wrap
        turn = make('geometry_msgs/msg/Quaternion', z=np.sin(yaw / 2), w=np.cos(yaw / 2))
        pose = make('geometry_msgs/msg/Pose', orientation=turn)
        with_pose = make('geometry_msgs/msg/PoseWithCovariance', pose=pose)
        unknown = np.zeros(36)
        unknown[0] = -1.0 if k == 1 else 0.0
        twist = make('geometry_msgs/msg/TwistWithCovariance', covariance=unknown)
        twist.twist.linear.x = 0.5
        sent.append(message('odom', 'nav_msgs/msg/Odometry', 0.1 * k, pose=with_pose, twist=twist))
        names, duties = ['left', 'right'], np.array([0.1 * k, 0.2])
        given = {'name': names, 'duty': duties}
        sent.append(message('motors', 'lta_msgs/msg/ActuatorDuty', 0.1 * k, **given))
        block = {'diodes': 2, 'counts': np.array([1, 10, 3, 10 + k], np.uint16)}
        sent.append(message('photodiodes', 'lta_msgs/msg/LightBlock', 0.1 * k, **block))
    return open_flight(record(sent))


def test_each_quantity_has_its_name_unit_and_values(flight):
    whole = read_flight(flight)
    assert whole.losses == ()
    found = whole.channels
    yaw = found['odom/pose.pose.orientation.yaw']
    assert (yaw.unit, yaw.angular, yaw.topic) == ('rad', True, 'odom')
    np.testing.assert_allclose(yaw.values, [3.0, 3.1, 3.2 - 2 * np.pi], atol=1e-12)
    np.testing.assert_allclose(yaw.time, [0.0, 0.1, 0.2], atol=1e-12)
    left = found['motors/effort.left']
    assert (left.unit, left.field) == ('1', 'effort.left')
    np.testing.assert_allclose(left.values, [0.0, 0.1, 0.2], atol=1e-12)
    np.testing.assert_array_equal(found['photodiodes/mean[1]'].values, [10.0, 10.5, 11.0])
    np.testing.assert_array_equal(found['photodiodes/std[0]'].values, [1.0, 1.0, 1.0])
    np.testing.assert_array_equal(found['photodiodes/max[1]'].values, [10.0, 11.0, 12.0])
    assert not any('header' in name or 'covariance' in name for name in found)


def test_what_a_message_declares_unknown_is_not_a_number(flight):
    surge = read_flight(flight).channels['odom/twist.twist.linear.x']
    np.testing.assert_array_equal(surge.values, [0.5, np.nan, 0.5])


def test_a_topic_that_cannot_be_decoded_is_named_and_the_rest_is_there(record):
    odd = {'diodes': 2, 'counts': np.zeros(3, np.uint16)}
    block = message('photodiodes', 'lta_msgs/msg/LightBlock', 0.0, **odd)
    lux = message('illuminance', 'sensor_msgs/msg/Illuminance', 0.0, illuminance=120.0)
    whole = read_flight(open_flight(record([block, lux])))
    assert whole.channels['illuminance/illuminance'].values.tolist() == [120.0]
    assert len(whole.losses) == 1
    assert whole.losses[0].startswith("Topic 'photodiodes' is left out: ")


@pytest.mark.parametrize(
    ('type_name', 'path', 'unit'),
    [
        ('nav_msgs/msg/Odometry', 'pose.pose.position.z', 'm'),
        ('nav_msgs/msg/Odometry', 'twist.twist.angular.z', 'rad/s'),
        ('nav_msgs/msg/Odometry', 'pose.covariance[0]', 'm2'),
        ('nav_msgs/msg/Odometry', 'pose.covariance[3]', 'm rad'),
        ('nav_msgs/msg/Odometry', 'twist.covariance[35]', 'rad2/s2'),
        ('geometry_msgs/msg/WrenchStamped', 'wrench.torque.x', 'N m'),
        ('tf2_msgs/msg/TFMessage', 'transforms[3].transform.translation.y', 'm'),
        ('sensor_msgs/msg/Imu', 'linear_acceleration.z', 'm/s2'),
        ('sensor_msgs/msg/BatteryState', 'cell_voltage[1]', 'V'),
        ('sensor_msgs/msg/BatteryState', 'power_supply_status', ''),
        ('someone/msg/Else', 'what.ever', ''),
    ],
)
def test_units_follow_the_message_type(type_name, path, unit):
    assert find_unit(type_name, path) == unit


def test_a_topic_of_ours_says_what_a_general_type_means():
    assert find_unit('sensor_msgs/msg/JointState', 'effort[2]', 'motors') == '1'
    assert find_unit('sensor_msgs/msg/JointState', 'effort[2]', 'arm/joints') == 'N m'


def test_every_message_type_of_the_table_has_units_for_its_physical_fields():
    """What stays without one: flags, enumerations, counts and texts."""
    plain = {'radiation_type', 'present', 'data', 'level', 'power_supply_status'}
    plain |= {'power_supply_health', 'power_supply_technology'}
    for name, topic in load_topic_table().topics.items():
        for path, kind in leaves(topic.type):
            if kind.startswith('float') and path.split('[')[0] not in plain:
                assert find_unit(topic.type, path, name), (name, path)


def leaves(type_name, before=''):
    """Yield path and kind of every plain field of a message type."""
    for field, (node, detail) in load_jazzy_types().fielddefs[type_name][1]:
        many = int(node) in (3, 4)
        node, detail = detail[0] if many else (node, detail)
        path = f'{before}{field}[0]' if many else f'{before}{field}'
        if int(node) == 2:
            yield from leaves(detail, f'{path}.')
        else:
            yield path, detail[0]
