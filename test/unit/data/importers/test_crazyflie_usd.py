# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Logs of a Crazyflie's SD card, written here byte by byte from the description of the format."""

import struct
import zlib

from lta_config.errors import BadInput
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

SECOND = 1_000_000_000

# One second of 0.5 s steps (version 2), and events of a second kind between them:
#
#   t [us]   500000      700000       1000000
#            fixed       rangeEvent   fixed
FIXED = ('fixedFrequency', [
    ('stateEstimate.x', 'f'), ('stateEstimate.y', 'f'), ('stateEstimate.z', 'f'),
    ('stabilizer.yaw', 'f'), ('stabilizer.pitch', 'f'), ('stabilizer.roll', 'f'),
    ('acc.x', 'f'), ('acc.y', 'f'), ('acc.z', 'f'), ('gyro.x', 'f'), ('gyro.y', 'f'),
    ('gyro.z', 'f'), ('motor.m1', 'H'), ('motor.m2', 'I'), ('motor.m3', 'H'), ('motor.m4', 'H'),
    ('pm.vbatMV', 'H'), ('baro.pressure', 'e'), ('system.canfly', 'b'),
])  # fmt: skip
RANGE = ('rangeEvent', [('range.zrange', 'H')])
VALUES = (1.5, -2.0, 0.25, 90.0, 10.0, -5.0, 0.0, 0.0, 1.0, 180.0, 0.0, -90.0)
COUNTS = (65535, 32768, 0, 13107, 3700, 992.0, 1)


def head(version, events):
    """Return the head: 0xBC, version, and the types of event with their variables."""
    data = b'\xbc' + struct.pack('<HH', version, len(events))
    for number, (name, variables) in enumerate(events):
        data += struct.pack('<H', number) + name.encode() + b'\x00'
        data += struct.pack('<H', len(variables))
        data += b''.join(f'{variable}({kind})'.encode() + b'\x00' for variable, kind in variables)
    return data


def fixed(version, time):
    start = struct.pack('<HI' if version == 1 else '<HQ', 0, time)
    return start + struct.pack('<12f', *VALUES) + struct.pack('<HIHHHeb', *COUNTS)


def event(version, time, distance):
    return struct.pack('<HIH' if version == 1 else '<HQH', 1, time, distance)


def log(version):
    unit = 1 if version == 1 else 1000
    body = fixed(version, 500 * unit) + event(version, 700 * unit, 1234)
    return head(version, [FIXED, RANGE]) + body + fixed(version, 1000 * unit)


def sealed(data):
    return data + struct.pack('<I', zlib.crc32(data))


@pytest.mark.parametrize('version', [1, 2])
def test_a_log_in_our_units_and_axes(bring, tmp_path, version):
    source = tmp_path / 'log00'
    source.write_bytes(sealed(log(version)))
    found = bring(source)
    assert found.imported.format == 'usd'
    assert found.imported.mapping == 'crazyflie_usd'
    assert found.stamps('/lta1/odom') == [1.5 * SECOND, 2 * SECOND]
    assert found.stamps('/lta1/range') == [1.7 * SECOND]
    assert found.messages['/lta1/range'][0].range == np.float32(1.234)
    odom = found.messages['/lta1/odom'][0]
    p, q = odom.pose.pose.position, odom.pose.pose.orientation
    assert (p.x, p.y, p.z) == (1.5, -2.0, 0.25)
    # 10 degrees nose up are -10 degrees about y, which points left.
    angles = Rotation.from_quat([q.x, q.y, q.z, q.w]).as_euler('ZYX', degrees=True)
    assert angles == pytest.approx([90.0, -10.0, -5.0])
    assert odom.twist.covariance[0] == -1.0
    imu = found.messages['/lta1/imu'][1]
    assert imu.linear_acceleration.z == 9.80665
    assert imu.angular_velocity.x == pytest.approx(np.pi)
    assert imu.angular_velocity.z == pytest.approx(-np.pi / 2)
    motors = found.messages['/lta1/motors'][0]
    assert motors.name == ['m1', 'm2', 'm3', 'm4']
    assert motors.effort.tolist() == [1.0, 32768 / 65535, 0.0, 0.2]
    assert found.messages['/lta1/battery'][0].voltage == np.float32(3.7)
    assert found.messages['/lta1/pressure'][0].fluid_pressure == 99_200.0
    unused = "The mapping does not use these columns of 'fixedFrequency': system.canfly."
    assert unused in found.notes
    assert 'CRC' not in found.notes


def test_events_keep_the_order_of_the_log(bring, tmp_path):
    (tmp_path / 'log00').write_bytes(sealed(log(2)))
    order = bring(tmp_path / 'log00').order
    assert order.index('/lta1/range') == len(order) // 2
    assert order[-1] != '/lta1/range'


@pytest.mark.parametrize('cut', [1, 3, 4, 5, 20])
def test_a_log_that_was_cut_short_is_read_as_far_as_it_goes(bring, tmp_path, cut):
    (tmp_path / 'log00').write_bytes(sealed(log(2))[:-cut])
    found = bring(tmp_path / 'log00')
    whole = 2 if cut <= 4 else 1
    assert len(found.messages['/lta1/odom']) == whole
    assert 'The checksum (CRC) does not match: the log was cut short or is damaged' in found.notes


def test_a_flipped_bit_is_said_and_what_can_be_read_is_kept(bring, tmp_path):
    data = bytearray(sealed(log(2)))
    data[-20] ^= 0x40
    (tmp_path / 'log00').write_bytes(data)
    found = bring(tmp_path / 'log00')
    assert len(found.messages['/lta1/odom']) == 2
    assert 'The checksum (CRC) does not match' in found.notes


def test_what_the_head_does_not_name_ends_the_log(bring, tmp_path):
    data = log(2) + struct.pack('<HQ', 9, 1_200_000) + b'????'
    (tmp_path / 'log00').write_bytes(sealed(data))
    assert 'the 14 bytes from there on are left out' in bring(tmp_path / 'log00').notes


@pytest.mark.parametrize(
    ('data', 'sentence'),
    [
        (b'\xbc\x09\x00\x00\x00', 'version 9'),
        (head(2, [FIXED])[:40], 'cut short or damaged'),
        (head(2, [('event', [('a.b', 'z')])]), "variable 'a.b(z)' has an unknown type"),
        (sealed(head(2, [FIXED])), 'is a Crazyflie log without events'),
        (
            sealed(head(2, [('e', [('my.own', 'f')])]) + struct.pack('<HQf', 0, 5, 1.0)),
            'has no data that the mapping',
        ),
    ],
)
def test_what_is_no_such_log_is_one_sentence(bring, tmp_path, data, sentence):
    (tmp_path / 'log00').write_bytes(data)
    with pytest.raises(BadInput) as told:
        bring(tmp_path / 'log00')
    assert sentence in str(told.value)
    assert not (tmp_path / 'out').exists()


def test_a_pulse_that_no_motor_has_is_left_out_and_said(bring, tmp_path):
    variables = [*((f'motor.m{k}', 'I') for k in (1, 2, 3, 4)), ('pm.vbat', 'f')]
    data = head(2, [('e', variables)]) + struct.pack('<HQIIIIf', 0, 10, 1, 2, 70_000, 4, 3.9)
    (tmp_path / 'log00').write_bytes(sealed(data))
    found = bring(tmp_path / 'log00')
    assert list(found.messages) == ['/lta1/battery']
    assert "'motors' is left out: Column 'motor.m3' has 70000 in row 1" in found.notes


def test_two_kinds_of_event_with_one_name_are_both_there(bring, tmp_path):
    kinds = [('e', [('pm.vbat', 'f')]), ('e', [('range.zrange', 'H')])]
    data = head(2, kinds) + struct.pack('<HQf', 0, 5, 3.5) + struct.pack('<HQH', 1, 6, 250)
    (tmp_path / 'log00').write_bytes(sealed(data))
    found = bring(tmp_path / 'log00')
    assert found.messages['/lta1/battery'][0].voltage == 3.5
    assert found.messages['/lta1/range'][0].range == 0.25


def test_a_payload_may_be_called_as_the_parts_of_an_event_are(bring, tmp_path):
    # The firmware's own: EVENTTRIGGER(estDistance, uint8, id, float, distance).
    variables = [('id', 'B'), ('distance', 'f'), ('time', 'I'), ('pm.vbat', 'f')]
    body = struct.pack('<HQBfIf', 3, 1_500_000, 7, 2.5, 99, 3.5)
    kinds = head(2, [('unused', [])] * 3 + [('estDistance', variables)])
    (tmp_path / 'log00').write_bytes(sealed(kinds + body))
    found = bring(tmp_path / 'log00')
    assert found.stamps('/lta1/battery') == [2_500_000_000]
    assert found.messages['/lta1/battery'][0].voltage == 3.5
    unused = "The mapping does not use these columns of 'estDistance': id, distance, time."
    assert unused in found.notes


def test_a_variable_that_is_logged_twice_is_there_twice(bring, tmp_path):
    variables = [('pm.vbat', 'f'), ('range.zrange', 'H'), ('pm.vbat', 'f')]
    body = struct.pack('<HQfHf', 0, 1_500_000, 3.5, 250, 4.0)
    (tmp_path / 'log00').write_bytes(sealed(head(2, [('e', variables)]) + body))
    found = bring(tmp_path / 'log00')
    assert found.messages['/lta1/battery'][0].voltage == 3.5
    assert found.messages['/lta1/range'][0].range == 0.25
    assert "The mapping does not use these columns of 'e': pm.vbat (3)." in found.notes
