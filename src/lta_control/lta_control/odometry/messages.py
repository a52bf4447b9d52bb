# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Convert the estimator's inputs from ROS messages, and its estimates to them."""

import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseWithCovarianceStamped, TwistWithCovarianceStamped
from lta_config.covariances import UNKNOWN_VARIANCE
from lta_control.allocation import pad_to_slots, PerRotor
from lta_control.estimator import (
    air_relative_velocity,
    EstimatorInputs,
    has_height,
    mask_out_of_range,
    MotionEstimate,
)
from lta_control.messages import to_diodes, to_lamp
from lta_control.motion import up_in_body, yaw_from_quaternion
from lta_control.odometry.ground_motion import ground_velocity
from lta_control.odometry.ground_state import GroundMotion, rotate_covariance
from lta_control.sighting import build_sighting, LampSighting
from lta_graph.lockstep import InboxStep
from lta_msgs.msg import ActuatorDuty, LampPeaks
from nav_msgs.msg import Odometry
import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import FluidPressure, Imu, Range

MOST_VARIANCE = 0.5 * UNKNOWN_VARIANCE  # of an estimate that is there
BAROMETER = 30e3, 125e3  # Pa, the range of the BMP388
# m; upper bound for the range finder of a small drone, whatever the message declares
LONGEST_RANGE = 100.0
YAW_DRIFT = 1e-3  # of the heading after the calibration [rad/s]: as measured in simulated flights
# Of the first heading [rad]: the gyroscope's noise turns it by 3e-4 rad within a second
YAW_START = 1e-3
# Of the range finder's constant offset [m]: an assumption, within the 2 cm of the VL53L1x
RANGE_DEVIATION = 0.01
# Of the altitude filter's variance of the climb rate. Its acceleration noise covers faults of the
# model; docs/control.md has the measured errors.
CLIMB_SHARE = 0.2
# Root mean square errors of simulated flights in still air, gusts and 0.4 m/s of wind, in which a
# drone sways while its biases are calibrated: of roll and pitch [rad], and of the rates [rad/s]
LEVEL_SIGMA = 0.01
RATE_SIGMA = 0.002
TILT_SIGMA = 0.015  # [rad] of the tilt, which turns the velocity: measured in flights


def to_inputs(step: InboxStep, commanded: PerRotor) -> EstimatorInputs:
    """Return the estimator's input from the newest messages of one step."""
    imu: Imu = step.last_message('imu')
    distance, air = step.last_message('range'), step.last_message('pressure')
    w, f = imu.angular_velocity, imu.linear_acceleration
    return EstimatorInputs(
        rates=(w.x, w.y, w.z),
        force=(f.x, f.y, f.z),
        range=math.nan if distance is None else to_distance(distance),
        pressure=math.nan if air is None else to_pressure(air),
        duties=commanded,
    )


def to_distance(message: Range) -> float:
    """Return a distance, or NaN outside the sensor's range (REP-117) [m]."""
    farthest = min(message.max_range, LONGEST_RANGE)
    return mask_out_of_range(float(message.range), message.min_range, farthest)


def to_pressure(message: FluidPressure) -> float:
    """Return a pressure, or NaN outside the barometer's range [Pa]."""
    return mask_out_of_range(message.fluid_pressure, *BAROMETER)


def to_duties(motors: ActuatorDuty | None, names: list[str], before: PerRotor) -> PerRotor:
    """Return the commanded duties by slot, or `before` without a valid command."""
    return (
        before
        if motors is None or not is_valid_command(motors, names)
        else pad_to_slots(motors.duty)
    )


def is_valid_command(motors: ActuatorDuty, names: list[str]) -> bool:
    """Return whether the duties belong to the vehicle's rotors and are from -1 to 1."""
    ours = list(motors.name) == names and len(motors.duty) == len(names)
    return ours and all(-1.0 <= duty <= 1.0 for duty in motors.duty)  # NaN compares false


def to_sighting(
    lamp: PoseWithCovarianceStamped | None, peaks: LampPeaks | None, age: float
) -> LampSighting | None:
    """Return the lamp as the estimator uses it; `age` is the time since mid-block [s]."""
    if lamp is None or peaks is None:
        return None
    axes, amplitudes = to_diodes(peaks)
    frequencies = tuple(peaks.beacon[0].frequency) if peaks.beacon else ()
    return build_sighting(to_lamp(lamp), axes, amplitudes, frequencies, age)


def from_estimate(stamp: Time, estimate: MotionEstimate, ground: GroundMotion) -> Odometry:
    """Return the motion over ground; variances are huge while the biases are calibrated."""
    message = Odometry()
    message.header.stamp = stamp
    message.header.frame_id = 'odom'
    message.child_frame_id = 'base_link'
    pose, twist = message.pose.pose, message.twist.twist
    p, q = pose.position, pose.orientation
    p.x, p.y = ground.position
    p.z = estimate.altitude.height
    q.x, q.y, q.z, q.w = estimate.attitude
    v, w = twist.linear, twist.angular
    v.x, v.y, v.z = ground_velocity(estimate, ground)
    w.x, w.y, w.z = estimate.rates
    if not estimate.ready:
        message.pose.covariance = _unknown_covariance()
        message.twist.covariance = _unknown_covariance()
        return message
    pose_covariance = _build_covariance(ground.position_covariance)
    is_known = has_height(estimate)
    pose_covariance[14] = (
        estimate.altitude.p[0] + RANGE_DEVIATION**2 if is_known else UNKNOWN_VARIANCE
    )
    # Roll and pitch are bounded by gravity; yaw drifts with the gyroscope
    pose_covariance[21] = pose_covariance[28] = LEVEL_SIGMA**2
    pose_covariance[35] = YAW_START**2 + (YAW_DRIFT * estimate.flight_time) ** 2
    message.pose.covariance = pose_covariance
    yaw = yaw_from_quaternion(estimate.attitude)
    message.twist.covariance = _build_twist_covariance(
        rotate_covariance(ground.velocity_covariance, yaw), ground.velocity, estimate
    )
    return message


def from_airspeed(
    stamp: Time, estimate: MotionEstimate, ground: GroundMotion
) -> TwistWithCovarianceStamped:
    """Return the velocity through the air and the rates; the covariance accounts for wind."""
    message = TwistWithCovarianceStamped()
    message.header.stamp = stamp
    message.header.frame_id = 'base_link'
    twist = message.twist.twist
    v, w = twist.linear, twist.angular
    v.x, v.y, v.z = air_relative_velocity(estimate)
    w.x, w.y, w.z = estimate.rates
    if not estimate.ready:
        message.twist.covariance = _unknown_covariance()
        return message
    yaw = yaw_from_quaternion(estimate.attitude)
    xx, xy, yy = rotate_covariance(ground.airspeed_covariance, yaw)
    # The law's airspeed is not that of the ground filter: their difference counts as error
    x, y = ground.airspeed
    cos, sin = math.cos(yaw), math.sin(yaw)
    ahead, aside = v.x - (cos * x + sin * y), v.y - (cos * y - sin * x)
    planar = xx + ahead * ahead, xy + ahead * aside, yy + aside * aside
    message.twist.covariance = _build_twist_covariance(planar, (x, y), estimate)
    return message


def _unknown_covariance() -> NDArray[np.float64]:
    return UNKNOWN_VARIANCE * np.eye(6).ravel()


def _build_covariance(planar: tuple[float, float, float]) -> NDArray[np.float64]:
    """Return a row-major 6 x 6 covariance, with xx, xy and yy."""
    # A position that has drifted for an hour is uncertain, but the estimate is there: motors must
    # not stop for that
    scale = min(1.0, MOST_VARIANCE / max(planar[0], planar[2], MOST_VARIANCE))
    # Order x y z roll pitch yaw: diagonal at 0, 7, 14, 21, 28, 35
    covariance = np.zeros(36)
    covariance[0], covariance[1], covariance[7] = (scale * each for each in planar)
    covariance[6] = covariance[1]
    return covariance


def _build_twist_covariance(
    planar: tuple[float, float, float], velocity: tuple[float, float], estimate: MotionEstimate
) -> NDArray[np.float64]:
    """Return the covariance of a twist in the body frame, from that of its level part."""
    covariance = _build_covariance(planar)
    square = velocity[0] * velocity[0] + velocity[1] * velocity[1]
    # A tilted z axis shows a part of the error of the level velocity
    x, y, _ = up_in_body(estimate.attitude)
    level = x * x * covariance[0] + 2.0 * x * y * covariance[1] + y * y * covariance[7]
    covariance[14] = CLIMB_SHARE * estimate.altitude.p[3] + TILT_SIGMA**2 * square + level
    covariance[21] = covariance[28] = covariance[35] = RATE_SIGMA**2
    return covariance
