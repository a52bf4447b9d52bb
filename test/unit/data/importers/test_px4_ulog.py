# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""ULogs of PX4, written here byte by byte from the description of the format (docs.px4.io)."""

import math
import struct

from lta_config.errors import BadInput
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

SIZES = {'uint64_t': 'Q', 'float': 'f', 'uint8_t': 'B', 'uint16_t': 'H', 'int32_t': 'i'}
FORMATS = {
    'vehicle_local_position': (
        'uint64_t timestamp;uint64_t timestamp_sample;'
        'float x;float y;float z;float vx;float vy;float vz;'
    ),
    'vehicle_attitude': 'uint64_t timestamp;float[4] q;',
    'vehicle_angular_velocity': 'uint64_t timestamp;float[3] xyz;',
    'sensor_combined': 'uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;',
    'actuator_motors': 'uint64_t timestamp;float[8] control;',
    'actuator_outputs': 'uint64_t timestamp;float[4] output;',
    'battery_status': 'uint64_t timestamp;float voltage_v;float current_a;float remaining;',
    'distance_sensor': (
        'uint64_t timestamp;float current_distance;float min_distance;float max_distance;'
        'uint8_t orientation;'
    ),
    'vehicle_air_data': 'uint64_t timestamp;float baro_pressure_pa;',
}


def message(kind, payload):
    """Return a message: size, type, content."""
    return struct.pack('<HB', len(payload), ord(kind)) + payload


def ulog(records):
    """Return a log of (name, values in the order of the format) with the definitions it needs."""
    data = b'ULog\x01\x12\x35\x01' + struct.pack('<Q', 0)
    data += message('B', bytes(40))  # flags: nothing that a reader need know
    names = list(dict.fromkeys(name for name, _ in records))
    for name in names:
        data += message('F', f'{name}:{FORMATS[name]}'.encode())
    for number, name in enumerate(names):
        data += message('A', struct.pack('<BH', 0, number) + name.encode())
    for name, values in records:
        kinds = ''
        for field in FORMATS[name].rstrip(';').split(';'):
            kind, _, count = field.split()[0].rstrip(']').partition('[')
            kinds += (count or '1') + SIZES[kind]
        content = struct.pack('<H', names.index(name)) + struct.pack('<' + kinds, *values)
        data += message('D', content)
    return data


# Level, nose to the east (yaw 90 degrees in NED): in ENU the nose is along x.
EAST = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
NAN = math.nan
FLIGHT = [
    ('vehicle_attitude', (1_900_000, 1.0, 0.0, 0.0, 0.0)),
    ('vehicle_attitude', (1_990_000, *EAST)),
    ('vehicle_angular_velocity', (1_995_000, 0.1, 0.2, 0.3)),
    ('vehicle_local_position', (2_003_000, 2_000_000, 10.0, 20.0, -3.0, 0.0, 2.0, 1.0)),
    ('vehicle_attitude', (2_001_000, 1.0, 0.0, 0.0, 0.0)),
    ('sensor_combined', (2_004_000, 0.1, 0.2, 0.3, 0.0, 0.0, -9.80665)),
    ('actuator_motors', (2_005_000, 0.5, 0.25, 0.75, 0.0, NAN, NAN, NAN, NAN)),
    ('battery_status', (2_006_000, 7.5, 2.0, 0.75)),
    ('battery_status', (2_106_000, 7.5, -1.0, -1.0)),
    ('distance_sensor', (2_007_000, 1.5, 0.25, 8.0, 25)),
    ('distance_sensor', (2_008_000, 4.5, 0.25, 8.0, 0)),
    ('vehicle_air_data', (2_009_000, 95_000.0)),
]


def test_a_log_in_our_units_and_axes(bring, tmp_path):
    source = tmp_path / 'flight.ulg'
    source.write_bytes(ulog(FLIGHT))
    found = bring(source)
    assert (found.imported.format, found.imported.mapping) == ('ulog', 'px4')
    (odom,) = found.messages['/lta1/odom']
    p, q = odom.pose.pose.position, odom.pose.pose.orientation
    assert (p.x, p.y, p.z) == (20.0, 10.0, 3.0)
    angles = Rotation.from_quat([q.x, q.y, q.z, q.w]).as_euler('ZYX')
    assert angles == pytest.approx([0, 0, 0], abs=1e-7)
    v, w = odom.twist.twist.linear, odom.twist.twist.angular
    assert [v.x, v.y, v.z] == pytest.approx([2.0, 0.0, -1.0], abs=1e-7)
    assert [w.x, w.y, w.z] == np.float32([0.1, -0.2, -0.3]).tolist()
    # The stamp is that of the sample, the log time that of the message.
    assert found.stamps('/lta1/odom') == [2_000_000_000]
    assert found.times['/lta1/odom'] == [2_003_000_000]
    assert 'latest logged values of vehicle_attitude and vehicle_angular_velocity' in found.notes
    assert 'at most 0.01 s old' in found.notes
    (imu,) = found.messages['/lta1/imu']
    assert imu.linear_acceleration.z == np.float32(9.80665)
    assert imu.angular_velocity.y == -np.float32(0.2)
    (motors,) = found.messages['/lta1/motors']
    assert motors.name == ['motor_1', 'motor_2', 'motor_3', 'motor_4']
    assert motors.effort.tolist() == [0.5, 0.25, 0.75, 0.0]
    silent = (
        'These parts of /lta1/motors have no values and are left out: '
        'motor_5, motor_6, motor_7, motor_8.'
    )
    assert silent in found.notes
    first, second = found.messages['/lta1/battery']
    assert (first.voltage, first.current, first.percentage) == (7.5, -2.0, 0.75)
    assert math.isnan(second.current)
    assert math.isnan(second.percentage)
    (distance,) = found.messages['/lta1/range']
    assert (distance.range, distance.min_range, distance.max_range) == (1.5, 0.25, 8.0)
    assert 'The mapping excludes 1 rows from /lta1/range.' in found.notes
    assert found.messages['/lta1/pressure'][0].fluid_pressure == 95_000.0


def test_pulses_are_duties_and_other_outputs_are_refused(bring, tmp_path):
    pulses = ('actuator_outputs', (3_000_000, 1000.0, 1500.0, 2000.0, 900.0))
    (tmp_path / 'a.ulg').write_bytes(ulog([pulses, ('vehicle_air_data', (3_000_000, 1e5))]))
    found = bring(tmp_path / 'a.ulg')
    assert found.messages['/lta1/motors'][0].effort.tolist() == [0.0, 0.5, 1.0, -0.1]


def test_digital_outputs_are_left_out_and_said(bring, tmp_path):
    shots = ('actuator_outputs', (3_000_000, 0.0, 48.0, 1046.0, 2047.0))
    (tmp_path / 'a.ulg').write_bytes(ulog([shots, ('vehicle_air_data', (3_000_000, 1e5))]))
    found = bring(tmp_path / 'a.ulg')
    assert list(found.messages) == ['/lta1/pressure']
    assert "'motors' is left out: Column 'output[0]' has 0 in row 1" in found.notes


def test_attitude_alone_is_an_odometry_without_a_place(bring, tmp_path):
    (tmp_path / 'a.ulg').write_bytes(ulog([('vehicle_attitude', (3_000_000, *EAST))]))
    (odom,) = bring(tmp_path / 'a.ulg').messages['/lta1/odom']
    assert odom.pose.covariance[0] == -1.0
    assert math.isnan(odom.pose.pose.position.x)


@pytest.mark.parametrize(
    ('data', 'sentence'),
    [
        (ulog(FLIGHT)[:12], 'cannot be read as a ULog'),
        (ulog([]), 'is a ULog without messages'),
    ],
)
def test_what_is_no_such_log_is_one_sentence(bring, tmp_path, data, sentence):
    (tmp_path / 'a.ulg').write_bytes(data)
    with pytest.raises(BadInput, match=sentence):
        bring(tmp_path / 'a.ulg')


def test_a_log_that_was_cut_short_is_read_as_far_as_it_goes(bring, tmp_path):
    (tmp_path / 'a.ulg').write_bytes(ulog(FLIGHT)[:-5])
    assert '/lta1/pressure' not in bring(tmp_path / 'a.ulg').messages
