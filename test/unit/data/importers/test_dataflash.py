# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""ArduPilot's DataFlash logs, assembled by hand, with pymavlink as the second reader."""

import struct

from lta_config.errors import BadInput
import pytest

ODOM, IMU = '/lta1/odom', '/lta1/imu'
HEAD = b'\xa3\x95'
TYPES = {
    'XKF1': (66, 'QBccCfffffff', 'TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD'),
    'IMU': (67, 'QBffffff', 'TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ'),
    'BAT': (68, 'QBff', 'TimeUS,Inst,Volt,Curr'),
    'RCOU': (69, 'QHHHH', 'TimeUS,C1,C2,C3,C4'),
    'MSG': (70, 'QZ', 'TimeUS,Message'),
}
SIZES = {'Q': 8, 'B': 1, 'c': 2, 'C': 2, 'f': 4, 'H': 2, 'Z': 64}


def define(name):
    kind, codes, labels = TYPES[name]
    size = 3 + sum(SIZES[code] for code in codes)
    return HEAD + struct.pack(
        '<BBB4s16s64s', 128, kind, size, name.encode(), codes.encode(), labels.encode()
    )


def message(name, *values):
    kind, codes, _ = TYPES[name]
    plain = codes.replace('c', 'h').replace('C', 'H').replace('Z', '64s')
    return HEAD + bytes([kind]) + struct.pack('<' + plain, *values)


FMT = HEAD + struct.pack(
    '<BBB4s16s64s', 128, 128, 89, b'FMT', b'BBnNZ', b'Type,Length,Name,Format,Columns'
)


def build_log():
    parts = [FMT, *map(define, TYPES)]
    parts.append(message('MSG', 900_000, b'ArduCopter V4.5'))
    for step in range(3):
        at = 2_000_000 + 20_000 * step
        # 10 deg roll, -5 deg pitch, 90 deg yaw; 1 m/s north; 2 m north, 3 m east, 4 m up
        parts.append(message('XKF1', at, 0, 1000, -500, 9000, 1.0, 0.0, 0.0, 0.0, 2.0, 3.0, -4.0))
        parts.append(message('XKF1', at, 1, 0, 0, 0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0))
        parts.append(message('IMU', at + 100, 0, 0.1, 0.2, 0.3, 0.0, 0.5, -9.81))
        parts.append(message('BAT', at + 200, 0, 7.5, 2.0))
        parts.append(message('RCOU', at + 300, 1000, 1250, 1500, 2000))
    return b''.join(parts)


def test_a_log_in_our_units_and_axes(bring, tmp_path):
    source = tmp_path / 'a.bin'
    source.write_bytes(build_log())
    got = bring(source)
    assert got.imported.mapping == 'ardupilot'
    assert got.stamps(ODOM) == [2_000_000_000, 2_020_000_000, 2_040_000_000]
    pose = got.messages[ODOM][0].pose.pose
    # NED to ENU: east, north, up
    assert (pose.position.x, pose.position.y, pose.position.z) == (3.0, 2.0, 4.0)
    # Yaw 90 deg of NED points east, along our x, so the vehicle flies with 1 m/s to its left
    speed = got.messages[ODOM][0].twist.twist.linear
    assert speed.y == pytest.approx(0.98481, abs=1e-4)
    assert abs(speed.x) < 1e-6
    felt = got.messages[IMU][0]
    assert felt.linear_acceleration.z == pytest.approx(9.81)
    assert felt.linear_acceleration.y == pytest.approx(-0.5)
    assert felt.angular_velocity.y == pytest.approx(-0.2)
    assert got.messages['/lta1/battery'][0].current == -2.0
    assert list(got.messages['/lta1/motors'][0].effort) == [0.0, 0.25, 0.5, 1.0]
    assert 'The mapping excludes 3 rows from /lta1/odom' in got.notes


def test_pymavlink_reads_the_same_numbers(tmp_path, monkeypatch):
    # pymavlink sets it when it is loaded
    monkeypatch.setenv('MAVLINK_DIALECT', 'ardupilotmega')
    from lta_data.importers.readers.dataflash import open_dataflash
    from pymavlink.DFReader import DFReader_binary

    source = tmp_path / 'a.bin'
    source.write_bytes(build_log())
    log = open_dataflash(source, None)
    reader = DFReader_binary(str(source))
    rows = dict.fromkeys(log.content, 0)
    while (found := reader.recv_msg()) is not None:
        name = found.get_type()
        if name in rows and name != 'MSG':
            table, row = log.content[name], rows[name]
            assert table.stamps[row] == found.TimeUS * 1000
            for column, values in table.columns.items():
                assert values[row] == pytest.approx(getattr(found, column), rel=1e-6)
            rows[name] += 1
    reader.close()
    assert rows['XKF1'] == 6
    assert rows['RCOU'] == 3


def test_what_is_damaged_is_skipped_and_counted(bring, tmp_path):
    source = tmp_path / 'a.bin'
    whole = build_log()
    at = whole.index(HEAD + bytes([67]))
    source.write_bytes(whole[:at] + b'noise' + whole[at:-10])
    got = bring(source)
    assert len(got.messages[IMU]) == 3
    assert len(got.messages['/lta1/motors']) == 2
    # 5 of noise, and 9 of 19 of the last message
    assert '14 bytes of the log are not a complete message' in got.notes


def test_a_log_of_definitions_only_is_refused(bring, tmp_path):
    source = tmp_path / 'a.bin'
    source.write_bytes(FMT + define('IMU'))
    with pytest.raises(BadInput, match='DataFlash log without messages'):
        bring(source)


OLD = {
    'NKF1': (71, 'QccCffffff', 'TimeUS,Roll,Pitch,Yaw,VN,VE,VD,PN,PE,PD'),
    'IMU': (72, 'QffffffI', 'TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,ErrG'),
    'BARO': (73, 'Qff', 'TimeUS,Alt,Press'),
}


def test_tables_without_numbers_of_their_sensors_are_those_of_the_first(
    bring, tmp_path, monkeypatch
):
    """As before ArduPilot 4.1."""
    monkeypatch.setitem(SIZES, 'I', 4)
    for name, layout in OLD.items():
        monkeypatch.setitem(TYPES, name, layout)
    parts = [FMT, *map(define, OLD)]
    for step in range(20):
        at = 5_000_000 + 20_000 * step
        parts.append(message('NKF1', at, 0, 0, 9000, 0.1, 0.0, 0.0, 1.0 + step, 3.0, -4.0))
        parts.append(message('IMU', at, 0.1, 0.2, 0.3, 0.0, 0.0, -9.81, 0))
        parts.append(message('BARO', at, 1.5, 1.01e5))
    source = tmp_path / 'old.BIN'
    source.write_bytes(b''.join(parts))
    got = bring(source)
    assert [len(got.messages[t]) for t in (ODOM, IMU, '/lta1/pressure')] == [20, 20, 20]
    place = got.messages[ODOM][2].pose.pose.position
    assert (place.x, place.y, place.z) == pytest.approx((3.0, 3.0, 4.0))
    assert got.messages[IMU][0].linear_acceleration.z == pytest.approx(9.81, rel=1e-6)


def test_a_log_of_old_px4_is_named(bring, tmp_path, monkeypatch):
    monkeypatch.setitem(TYPES, 'TIME', (129, 'Q', 'StartTime'))
    source = tmp_path / 'sess001.bin'
    source.write_bytes(b''.join([FMT, define('TIME'), message('TIME', 1_000_000)]))
    with pytest.raises(BadInput, match='sdlog2'):
        bring(source)
