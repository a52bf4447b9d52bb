# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Clock, log table, units and packets of the Crazyflie bridge, against hand calculation."""

import math
import struct

from lta_bridge.crazyflie import duties_packet, messages, readings
from lta_bridge.crazyflie.bridge_core import BridgeCore, CrazyflieCommand, PositionEstimate
from lta_bridge.crazyflie.device_clock import DeviceClock, parse_ping_time, RoundTrips
from lta_bridge.crazyflie.link import LogPacket
from lta_bridge.crazyflie.log_table import block_size, LOG_BLOCKS
from lta_bridge.crazyflie.safety import find_missing_position, SafetyLimits
from lta_config.covariances import UNKNOWN_VARIANCE
from lta_config.schema.crazyflie_file import load_crazyflie
from lta_emulation.crazyflie.parameters import LOG
from lta_graph.ros.stamps import to_stamp
from lta_model.vehicle import load_vehicle
from nav_msgs.msg import Odometry
import numpy as np
import pytest

MS = 1_000_000


def fly(clock, seconds, drift=0.0, boot_ms=0, latency=None, seed=1):
    """Return the error of each stamp of packets every 10 ms, sent when stamped [ms]."""
    chance = np.random.default_rng(seed)
    errors = []
    for turn in range(round(100 * seconds)):
        device_ms = boot_ms + 10 * turn
        true_ns = 10**18 + round(10 * turn * MS / (1.0 + drift))
        late = round(MS * (2.0 + chance.exponential(3.0) if latency is None else latency))
        told = clock.compute_packet_time(device_ms & 0xFFFFFF, true_ns + late)
        assert told <= true_ns + late
        errors.append((told - true_ns) / MS)
    return np.array(errors)


def test_the_drift_of_a_crystal_is_found():
    clock = DeviceClock()
    errors = fly(clock, 60.0, drift=40e-6, latency=2.0)
    assert clock.drift == pytest.approx(40e-6, abs=2e-6)
    assert np.abs(errors[1000:] - 2.0).max() < 0.1


def test_the_stamp_wraps_after_four_and_a_half_hours():
    clock = DeviceClock()
    errors = fly(clock, 10.0, boot_ms=(1 << 24) - 5000, latency=2.0)
    assert errors == pytest.approx(2.0, abs=1e-6)
    assert clock.line.restarts == 0


def test_late_and_swapped_packets_keep_their_own_stamps():
    clock = DeviceClock()
    stamps = [clock.compute_packet_time(ms, 10**18 + 1_000 * MS) for ms in (1000, 990, 995)]
    assert [stamps[0] - one for one in stamps] == [0, 10 * MS, 5 * MS]


@pytest.mark.parametrize('back_s', [0.2, 3.0, 9.0])
def test_a_clock_that_is_set_back_a_little_is_learnt_anew(back_s):
    """One that started anew within its first seconds: at once, not after the line's minute."""
    clock, back = DeviceClock(), round(1000 * back_s)
    for ms in range(0, 9500, 10):
        clock.compute_packet_time(ms, 10**18 + (ms + 2) * MS)
    for ms in range(9500, 10500, 10):
        told = clock.compute_packet_time(ms - back, 10**18 + (ms + 2) * MS)
        assert told == pytest.approx(10**18 + (ms + 2) * MS, abs=1000)
    assert clock.line.restarts == 1


def test_stamps_are_set_back_by_half_of_the_quickest_round_trip():
    trips = RoundTrips()
    assert (trips.one_way_ns, math.isnan(trips.latency)) == (0, True)
    for took in (0.010, 0.004, 0.030, -1.0, 3600.0, math.nan):
        trips.add(took)
    assert trips.one_way_ns == 2 * MS
    assert trips.latency == pytest.approx(0.028)  # 0.9 of the way from 10 to 30 ms
    bridge = BridgeCore(None, load_crazyflie('gtmab'), load_vehicle('gtmab'))
    bridge.add_round_trip(0.004)
    errors = [
        bridge.receive_packet(LogPacket('none', 10 * k, {}, 10**18 + (10 * k + 2) * MS)).stamp_ns
        - (10**18 + 10 * k * MS)
        for k in range(50)
    ]
    assert np.abs(errors).max() <= 1000


def test_units_and_signs():
    values = {'acc.x': 0.5, 'acc.y': 0.0, 'acc.z': 1.0, 'gyro.x': 180.0, 'gyro.y': -90.0}
    moved = readings.convert_imu({**values, 'gyro.z': 0.0})
    assert moved.force == pytest.approx((4.903325, 0.0, 9.80665))
    assert moved.rates == pytest.approx((math.pi, -math.pi / 2, 0.0))
    felt = readings.convert_air({'baro.pressure': 1013.25, 'range.zrange': 450})
    assert felt == pytest.approx((101325.0, 0.45))
    assert readings.convert_air({'baro.pressure': 1.0, 'range.zrange': 8190}).distance == math.inf
    nose_up = readings.convert_attitude(
        {'stateEstimate.roll': 0.0, 'stateEstimate.pitch': 90.0, 'stateEstimate.yaw': 0.0}
    )
    # FLU: pitch about +y puts the nose down, so nose up is a negative turn.
    assert nose_up == pytest.approx((0.0, -math.sqrt(0.5), 0.0, math.sqrt(0.5)))
    told = readings.convert_motors(
        {**{f'motor.m{n}': 13107.0 * n for n in range(1, 5)}, 'supervisor.info': 2}
    )
    assert told.duties == pytest.approx((0.2, 0.4, 0.6, 0.8))


def test_the_table_fits_a_crazyflie_that_knows_its_variables():
    """The limits are those of the firmware's log.c."""
    known = {variable.name for variable in LOG}
    assert {name for block in LOG_BLOCKS for name in block.variables} <= known
    assert all(block_size(block) <= 26 for block in LOG_BLOCKS)
    assert all(block.period_ms in range(10, 2541, 10) for block in LOG_BLOCKS)
    assert len(LOG_BLOCKS) <= 16
    assert sum(len(block.variables) for block in LOG_BLOCKS) <= 128


def test_duties_on_the_wire():
    data = duties_packet.pack_duties(259, (1.0, -1.0, 0.5, math.nan), 250)
    assert data == bytes.fromhex('4c 03 ff7f 0180 0040 0000 fa00')
    told = duties_packet.unpack_duties(data)
    assert (told.sequence, told.timeout_ms) == (3, 250)
    assert duties_packet.unpack_duties(data[:-1]) is None
    assert duties_packet.unpack_duties(b'\0' + data[1:]) is None
    assert duties_packet.is_newer(0, 255)
    assert not duties_packet.is_newer(255, 0)
    assert not duties_packet.is_newer(7, 7)
    # Half of the circle, 128, is no longer ahead.
    assert [duties_packet.is_newer(ahead, 0) for ahead in (1, 127, 128, 255)] == [
        True,
        True,
        False,
        False,
    ]
    assert duties_packet.unpack_duties(data).duties == (1.0, -1.0, 16384 / 32767, 0.0)


def test_what_ends_a_flight_stands_in_the_file_alone():
    file = load_crazyflie('gtmab')
    bridge = BridgeCore(None, file, load_vehicle('gtmab'))
    told = file.limits
    assert bridge.limits == (told.voltage.si, told.time.si, told.height.si, told.distance.si)
    assert not SafetyLimits._field_defaults


@pytest.mark.parametrize(
    ('ahead_s', 'known'), [(0.0, True), (0.2, True), (0.4, False), (3600, False)]
)
def test_a_command_of_the_future_is_none(ahead_s, known):
    """Of a computer whose clock is wrong: as the newest one it would be flown for an hour."""
    bridge = BridgeCore(None, load_crazyflie('gtmab'), load_vehicle('gtmab'))
    bridge.accept_command(CrazyflieCommand(10**18 + round(1e9 * ahead_s), duties=(0.1,) * 4))
    assert math.isfinite(bridge.collect_safety_inputs(10**18, True, True).command_age) == known


def test_limits_of_height_and_way_age_with_the_estimate_that_they_are_of():
    """They would stand at its last word, whoever goes on commanding."""
    bridge = BridgeCore(None, load_crazyflie('gtmab'), load_vehicle('gtmab'))
    assert math.isinf(bridge.collect_safety_inputs(10**18, True, True).place_age)
    odom = Odometry()
    odom.header.stamp = to_stamp(10**18)
    odom.pose.pose.position.z = 0.4
    bridge.update_position(messages.to_position(odom))
    seen = bridge.collect_safety_inputs(10**18 + 2_500 * MS, True, True)
    assert (seen.height, seen.place_age) == pytest.approx((0.4, 2.5))
    odom.pose.covariance[0] = UNKNOWN_VARIANCE  # calibrating at 0 m
    assert messages.to_position(odom) is None
    odom.pose.covariance[0] = 0.0
    odom.pose.covariance[14] = UNKNOWN_VARIANCE  # both sensors of its height are lost
    bridge.update_position(messages.to_position(odom))
    assert find_missing_position(bridge.collect_safety_inputs(10**18, True, True))


def test_a_tracker_counts_as_an_estimate_and_the_farther_of_two_decides():
    bridge = BridgeCore(None, load_crazyflie('gtmab'), load_vehicle('gtmab'))
    bridge.update_tracked_position(PositionEstimate(1.0, 3.0, 10**18))
    seen = bridge.collect_safety_inputs(10**18, True, True)
    assert (seen.height, seen.distance, seen.place_age) == (1.0, 3.0, 0.0)
    bridge.update_position(PositionEstimate(2.0, 1.0, 10**18 - 100 * MS))
    seen = bridge.collect_safety_inputs(10**18, True, True)
    assert (seen.height, seen.distance) == (2.0, 3.0)
    assert seen.place_age == pytest.approx(0.1)
    seen = bridge.collect_safety_inputs(10**18 + 450 * MS, True, True)  # only the tracker is left
    assert (seen.height, seen.distance) == (1.0, 3.0)
    assert seen.place_age == pytest.approx(0.45)


def test_a_clock_that_is_set_back_makes_no_silence_fresh():
    bridge = BridgeCore(None, load_crazyflie('gtmab'), load_vehicle('gtmab'))
    values = {f'motor.m{n}': 0.0 for n in range(1, 5)} | {'supervisor.info': 2.0}
    bridge.receive_packet(LogPacket('motors', 1000, values, 10**18))
    assert bridge.collect_safety_inputs(10**18 + 100 * MS, True, True).silence == pytest.approx(
        0.1
    )
    assert math.isinf(bridge.collect_safety_inputs(10**18 - 3600 * 1000 * MS, True, True).silence)


@pytest.mark.parametrize(('back_ms', 'restarts'), [(100, 0), (101, 1)])
def test_a_packet_is_a_tenth_of_a_second_late_or_of_another_clock(back_ms, restarts):
    clock = DeviceClock()
    clock.compute_packet_time(5000, 10**18)
    clock.compute_packet_time(5000 - back_ms, 10**18)
    assert clock.line.restarts == restarts


def test_the_round_trips_of_a_minute_are_kept_and_the_newest_ten_seconds_told():
    """Ten pings are sent each second."""
    trips = RoundTrips()
    for took in (0.0, 10.0, 9.9, *[0.030] * 498, 0.002, *[0.008] * 100):
        trips.add(took)
    assert trips.one_way_ns == 1 * MS
    assert trips.latency == pytest.approx(0.008)
    trips.add(9.0)
    trips.add(9.0)
    assert trips.latency == pytest.approx(0.008)  # 95 of the newest 100
    for _ in range(497):
        trips.add(0.020)
    assert trips.one_way_ns == 1 * MS
    trips.add(0.020)
    trips.add(0.020)
    assert trips.one_way_ns == 4 * MS


def test_a_ping_is_told_by_its_mark_and_its_size():
    ping = b'\0' + struct.pack('<d', 12.5)
    assert parse_ping_time(ping) == 12.5
    assert parse_ping_time(b'\1' + ping[1:]) is None
    assert parse_ping_time(ping + b'\0') is None


def test_a_range_of_five_metres_is_none():
    told = [
        readings.convert_air({'baro.pressure': 1.0, 'range.zrange': mm}).distance
        for mm in (4999, 5000)
    ]
    assert told == [pytest.approx(4.999), math.inf]
