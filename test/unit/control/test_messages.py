# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Estimates and setpoints as ROS messages: frames, signs, and what is unknown."""

import math

from lta_config.covariances import UNKNOWN_VARIANCE
from lta_control.allocation import NO_ROTORS, pad_to_slots
from lta_control.estimator import air_relative_velocity, mask_out_of_range, MotionEstimate
from lta_control.guidance import (
    decide_permission,
    explain_restriction,
    ReserveReport,
    ReserveResponseSettings,
)
from lta_control.messages import (
    from_duties,
    from_setpoint,
    to_air_motions,
    to_air_velocity,
    to_attitude,
    to_cascade_measurement,
    to_diodes,
    to_setpoint,
    update_reserve_report,
)
from lta_control.mission import FlightPermission
from lta_control.motion import has_overturned, Setpoint, yaw_from_quaternion
from lta_control.motion_filters import AirspeedEstimate, AltitudeEstimate
from lta_control.odometry.ground_state import GroundMotion
from lta_control.odometry.messages import from_airspeed, from_estimate, to_distance, to_duties
from lta_graph.lockstep import InboxStep
from lta_msgs.msg import ActuatorDuty, EnergyStatus
from lta_vlc.demodulation import Peaks
from lta_vlc.messages import from_peaks
import numpy as np
import pytest
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, Header

PITCH = 0.3  # nose down
FLYING = MotionEstimate(
    ready=True,
    attitude=(0.0, math.sin(PITCH / 2), 0.0, math.cos(PITCH / 2)),
    rates=(0.01, 0.02, 0.03),
    altitude=AltitudeEstimate(0.5, 0.1),
    airspeed=AirspeedEstimate(0.4, 0.05, 0.4, 0.05),
    flight_time=10.0,
)


WIND_X, WIND_Y = -0.3, 0.1
# Drift of 0.2 m/s back and 0.1 m/s to the left, known within 0.05 and 0.1 m/s; wind within 0.1 m/s
VARIANCES = (0.04, 0.09, 0.0025, 0.01, 0.01, 0.01, 0.0, 0.0, 0.0)
GROUND = GroundMotion(
    (2.0, 1.0, -0.2, 0.1, WIND_X, WIND_Y, 0.0, 0.0, 0.0),
    np.diag(VARIANCES),
    air=(0.4, 0.05),
)


def odometry(estimate, ground=GROUND):
    return from_estimate(Range().header.stamp, estimate, ground)


def air(estimate, ground=GROUND):
    return from_airspeed(Range().header.stamp, estimate, ground)


def test_the_twist_is_in_the_body_frame():
    """Nose down by 0.3: 0.4 m/s ahead sinks, so a climb of 0.1 m/s needs that much more heave."""
    by_hand = (0.1 + 0.4 * math.sin(PITCH)) / math.cos(PITCH)
    assert air_relative_velocity(FLYING)[2] == pytest.approx(by_hand)
    message = air(FLYING).twist.twist
    assert message.linear.z == pytest.approx(by_hand)
    assert (message.linear.x, message.linear.y, message.angular.z) == (0.4, 0.05, 0.03)


def test_odom_has_the_velocity_over_ground():
    """0.2 m/s ahead and 0.15 m/s to the left at a climb of 0.1 m/s, seen with the nose down."""
    twist = odometry(FLYING).twist
    v = twist.twist.linear
    cos, sin = math.cos(PITCH), math.sin(PITCH)
    assert (v.x, v.y) == pytest.approx((0.2 * cos - 0.1 * sin, 0.15))
    assert v.z == pytest.approx(0.2 * sin + 0.1 * cos)
    assert twist.covariance[0] == pytest.approx(0.0025)
    assert twist.covariance[7] == pytest.approx(0.01)


@pytest.mark.parametrize(('seconds', 'deviation'), [(0.0, 1e-3), (60.0, 0.06)])
def test_the_heading_is_never_certain(seconds, deviation):
    """It drifts by 0.06 rad a minute; a filter that fuses it cannot use a variance of 0."""
    covariance = odometry(FLYING._replace(flight_time=seconds)).pose.covariance
    assert math.sqrt(covariance[35]) == pytest.approx(deviation, rel=1e-3)


def test_a_covariance_turns_with_the_nose():
    left = (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4))
    covariance = odometry(FLYING._replace(attitude=left)).twist.covariance
    assert (covariance[0], covariance[7]) == pytest.approx((0.01, 0.0025))


def test_the_covariance_of_the_airspeed_counts_what_the_filter_knows_better():
    """The filter has 0.5 and 0.05 m/s through the air, the law 0.4 and 0.05 m/s."""
    covariance = air(FLYING).twist.covariance
    assert covariance[0] == pytest.approx(0.0025 + 0.01 + 0.1**2)
    assert covariance[7] == pytest.approx(0.01 + 0.01 + 0.0**2)


def test_an_old_recording_has_the_airspeed_in_odom():
    message = odometry(FLYING)
    v = message.twist.twist.linear
    assert to_air_velocity(message, air(FLYING)) == air_relative_velocity(FLYING)
    assert to_air_velocity(message, None) == (v.x, v.y, v.z)
    surge, sway, _ = air_relative_velocity(FLYING)
    yaw = yaw_from_quaternion(to_attitude(message))
    stamped = [(5, message, air(FLYING)), (7, message, None)]
    assert to_air_motions(stamped) == [(5, yaw, surge, sway), (7, yaw, v.x, v.y)]


def test_the_climb_comes_back():
    measured = to_cascade_measurement(odometry(FLYING), air(FLYING))
    assert measured.climb == pytest.approx(0.1)
    assert measured == pytest.approx((0.5, 0.1, 0.0, 0.03, 0.4, 0.05, 0.02), abs=1e-12)


def test_an_estimate_that_is_not_ready_is_unknown():
    message = odometry(MotionEstimate())
    assert to_cascade_measurement(message) is None
    # As RViz and fusion nodes read it: known to a kilometre
    for covariance in (message.pose.covariance, message.twist.covariance):
        assert np.diag(covariance.reshape(6, 6)).tolist() == [UNKNOWN_VARIANCE] * 6
    message.pose.covariance[0] = -1.0  # in old recordings
    assert to_cascade_measurement(message) is None


def test_a_position_that_is_lost_is_no_reason_to_stop_the_motors():
    lost = np.diag(VARIANCES)
    lost[:2, :2] = [[4e9, 1e9], [1e9, 2e9]]  # m2, after a day without a lamp
    lost = GROUND._replace(rows=lost)
    message = odometry(FLYING, lost)
    assert to_cascade_measurement(message) is not None
    planar = message.pose.covariance.reshape(6, 6)[:2, :2]
    assert planar.max() < UNKNOWN_VARIANCE
    # The shape stays: the same correlation, and no negative variance along any axis
    assert planar / planar[0, 0] == pytest.approx(np.array([[1.0, 0.25], [0.25, 0.5]]))


def test_the_position_says_how_far_off_it_may_be():
    pose = odometry(FLYING).pose
    assert (pose.pose.position.x, pose.pose.position.y) == (2.0, 1.0)
    assert (pose.covariance[0], pose.covariance[7]) == (0.04, 0.09)


@pytest.mark.parametrize('distance', [0.039, 4.01, math.inf, -math.inf, math.nan, 0.0])
def test_a_distance_out_of_reach_is_none(distance):
    message = Range(min_range=0.04, max_range=4.0, range=distance)
    assert math.isnan(to_distance(message))


def test_a_setpoint_survives_the_way_there_and_back():
    asked = Setpoint(0.7, -2.5, 0.3)
    assert to_setpoint(*from_setpoint(Range().header.stamp, asked)) == pytest.approx(asked)


@pytest.mark.parametrize(
    ('names', 'duties'), [(['a', 'b'], [0.1, 0.2]), (['a', 'b', 'c', 'd'], [0.1] * 3)]
)
def test_duties_that_do_not_fit_leave_those_before(names, duties):
    before = pad_to_slots((0.1, 0.2, 0.3, 0.4))
    motors = ActuatorDuty(name=names, duty=duties)
    assert to_duties(motors, ['a', 'b', 'c', 'd'], before) == before
    assert to_duties(None, ['a', 'b', 'c', 'd'], before) == before


@pytest.mark.parametrize('count', [1, 2, 4, 6, 8])
def test_duties_survive_the_way_there_and_back(count):
    names = [f'rotor{index}' for index in range(count)]
    duties = pad_to_slots(0.1 * index + 0.1 for index in range(count))
    message = from_duties(Range().header.stamp, names, duties)
    assert list(message.name) == names
    assert list(message.duty) == list(duties[:count])
    assert to_duties(message, names, NO_ROTORS) == duties


def test_distances_at_the_limits_of_a_sensor_are_valid():
    assert (mask_out_of_range(0.04, 0.04, 4.0), mask_out_of_range(4.0, 0.04, 4.0)) == (0.04, 4.0)
    assert math.isnan(mask_out_of_range(0.03, 0.04, 4.0))
    assert math.isnan(mask_out_of_range(4.1, 0.04, 4.0))


@pytest.mark.parametrize(('upright', 'levelled'), [(0.11, True), (0.09, False)])
def test_heave_is_the_climb_rate_where_body_z_is_nearly_level(upright, levelled):
    """The vehicle is pitched nose down; the limit is a cosine of 0.1 between body z and up."""
    pitch = math.acos(upright)
    side = FLYING._replace(attitude=(0.0, math.sin(pitch / 2), 0.0, math.cos(pitch / 2)))
    heave = (0.1 + 0.4 * math.sin(pitch)) / upright
    assert air_relative_velocity(side) == (0.4, 0.05, pytest.approx(heave if levelled else 0.1))


def test_the_climb_rate_of_a_rolled_vehicle_includes_its_sway():
    roll = 0.3
    rolled = FLYING._replace(attitude=(math.sin(roll / 2), 0.0, 0.0, math.cos(roll / 2)))
    heave = (0.1 - 0.05 * math.sin(roll)) / math.cos(roll)
    assert air_relative_velocity(rolled) == pytest.approx((0.4, 0.05, heave))
    measured = to_cascade_measurement(odometry(rolled), air(rolled))
    assert measured.climb == pytest.approx(0.1)


def battery_status(level, why):
    return EnergyStatus(level=level[0], message=why)


def energy(stamp, reserve=None, level=None, why=''):
    """Return a step with the energy monitor's reserve, its status, both or neither."""
    heard = {
        'energy/reserve': [] if reserve is None else [Bool(data=reserve)],
        'energy/status': [] if level is None else [battery_status(level, why)],
    }
    return InboxStep(stamp, heard, heard, {})


def test_reserve_and_status_may_come_in_different_steps():
    ok = update_reserve_report(None, energy(1, False, b'\x00', 'all is well'))
    assert ok == ReserveReport(1, False, False, 'all is well', 1)
    assert update_reserve_report(ok, energy(2)) == ok
    # Their order does not matter; each has its own stamp
    first = update_reserve_report(
        update_reserve_report(ok, energy(2, level=b'\x02', why='hot')), energy(3, True)
    )
    last = update_reserve_report(
        update_reserve_report(ok, energy(3, True)), energy(4, level=b'\x02', why='hot')
    )
    assert first == ReserveReport(3, True, True, 'hot', 2)
    assert last == ReserveReport(3, True, True, 'hot', 4)


def test_without_a_reserve_message_the_reserve_counts_as_reached():
    assert update_reserve_report(None, energy(1)) is None
    assert update_reserve_report(None, energy(1, level=b'\x01', why='warm')) == ReserveReport(
        1, True, False, 'warm', 1
    )
    assert update_reserve_report(None, energy(1, False)) == ReserveReport(1, False, False, '', 1)


@pytest.mark.parametrize('lost', ['reserve', 'status'])
def test_a_report_is_as_old_as_its_older_part(lost):
    settings, second = ReserveResponseSettings(), 1_000_000_000
    report = update_reserve_report(None, energy(0, False, b'\x00'))
    for k in range(1, 16):
        reserve, level = (None, b'\x00') if lost == 'reserve' else (False, None)
        now_ns = k * second // 10
        report = update_reserve_report(report, energy(now_ns, reserve, level))
        permission = decide_permission(settings, report, now_ns)
        assert permission is (FlightPermission.FLY if k <= 10 else FlightPermission.DOWN)
    assert explain_restriction(settings, report, 3 * second) == (
        'no report from the energy monitor for 3.0 s'
    )


def test_a_status_of_error_is_urgent_without_a_reserve_message():
    ok = update_reserve_report(None, energy(1, False, b'\x00'))
    assert update_reserve_report(ok, energy(2, level=b'\x01')).urgent is False
    assert update_reserve_report(ok, energy(2, level=b'\x02', why='hot')).urgent is True


AXES = ((1.0, 0.0, 0.0), (math.cos(0.7), math.sin(0.7), 0.0))


def light_peaks(*first):
    """Return peaks of two diodes as a message: the first beacon's amplitudes, and a second's."""
    ones = np.ones(2)
    beacons = [Peaks(np.array(first), ones, ones, ones), Peaks(ones, ones, ones, ones)]
    return from_peaks(Header(), tuple(beacons), AXES)


def test_diodes_are_those_of_the_first_beacon_in_single_precision():
    axes, amplitudes = to_diodes(light_peaks(0.1, 20.0))
    assert amplitudes == (float(np.float32(0.1)), 20.0)
    assert axes == tuple((float(np.float32(x)), float(np.float32(y))) for x, y, _ in AXES)
    assert to_diodes(None) == to_diodes(from_peaks(Header(), (), AXES)) == ((), ())


def test_an_axis_that_is_not_a_number_leaves_no_diodes():
    ones = np.ones(2)
    broken = from_peaks(
        Header(), (Peaks(ones, ones, ones, ones),), ((math.nan, 0.0, 0.0), AXES[1])
    )
    assert to_diodes(broken) == ((), ())


def test_it_is_overturned_beyond_the_limit_and_not_without_an_attitude():
    tilted = odometry(FLYING)
    assert has_overturned(to_attitude(tilted), math.cos(PITCH - 1e-6))
    assert not has_overturned(to_attitude(tilted), math.cos(PITCH + 1e-6))
    # A missing attitude has its own reason to stop the motors
    tilted.pose.pose.orientation.w = math.nan
    assert not has_overturned(to_attitude(tilted), math.cos(PITCH - 1e-6))
