"""Convert estimates, setpoints and duties to and from ROS messages."""

import array
from collections.abc import Iterable
from itertools import chain
import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import (
    PoseStamped,
    PoseWithCovarianceStamped,
    TwistStamped,
    TwistWithCovarianceStamped,
)
from lta_config.covariances import has_estimate, UNKNOWN_VARIANCE
from lta_control.altitude import mask_out_of_range
from lta_control.attitude import (
    level_quaternion,
    Quaternion,
    up_in_body,
    Vector,
    yaw_from_quaternion,
)
from lta_control.cascade import CascadeMeasurement, FLOOR_SETPOINT, Setpoint
from lta_control.estimator import (
    air_relative_velocity,
    EstimatorInputs,
    has_height,
    MotionEstimate,
)
from lta_control.flight_step import ControlInputs, measure_motion
from lta_control.laws.protocol import ControlMotion
from lta_control.odometry.ground_motion import ground_velocity
from lta_control.odometry.ground_state import GroundMotion, rotate_covariance
from lta_control.odometry.tracked_motion import OdomMotion, rotate, TrackedMotion
from lta_control.per_rotor import pad_to_slots, PerRotor
from lta_control.reserve import ReserveReport
from lta_control.sighting import build_sighting, LampPosition, LampSighting
from lta_graph.blank_message import create_message
from lta_graph.health import HealthLevel, stamp_age
from lta_graph.inbox import InboxStep
from lta_graph.ros.stamps import from_stamp
from lta_msgs.msg import ActuatorDuty, LampPeaks
from nav_msgs.msg import Odometry
import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import FluidPressure, Imu, Range

DiodeReadings = tuple[tuple[tuple[float, float], ...], tuple[float, ...]]

MOST_VARIANCE = 0.5 * UNKNOWN_VARIANCE  # of an estimate that is there
BAROMETER = 30e3, 125e3  # Pa, the range of the BMP388
# m; upper bound for the range finder of a small drone, whatever the message declares
LONGEST_RANGE = 100.0
FARTHEST_PLACE = 1e4  # m from the origin, and m/s: beyond any hall
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
    """Return a distance, or NaN outside the sensor's range (REP-117). [m]"""
    farthest = min(message.max_range, LONGEST_RANGE)
    return mask_out_of_range(float(message.range), message.min_range, farthest)


def to_pressure(message: FluidPressure) -> float:
    """Return a pressure, or NaN outside the barometer's range. [Pa]"""
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


def from_estimate(stamp: Time, estimate: MotionEstimate, ground: GroundMotion) -> Odometry:
    """Return the motion over ground; variances are huge while the biases are calibrated."""
    message = create_message(Odometry)
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
    message = create_message(TwistWithCovarianceStamped)
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


def to_air_velocity(odom: Odometry, airspeed: TwistWithCovarianceStamped | None) -> Vector:
    """
    Return the velocity through the air, body frame. [m/s]

    Without an airspeed, that of `odom`: recordings of earlier versions have the velocity through
    the air there, and without wind it is that over ground.
    """
    v = (odom if airspeed is None else airspeed).twist.twist.linear
    return v.x, v.y, v.z


def to_air_motions(
    stamped: Iterable[tuple[int, Odometry, TwistWithCovarianceStamped | None]],
) -> list[tuple[int, float, float, float]]:
    """Return each stamp with heading [rad] and velocity through the air, body x y [m/s]."""
    motions = []
    for stamp_ns, odom, airspeed in stamped:
        q, v = odom.pose.pose.orientation, (airspeed or odom).twist.twist.linear
        motions.append((stamp_ns, yaw_from_quaternion((q.x, q.y, q.z, q.w)), v.x, v.y))
    return motions


def to_attitude(message: Odometry) -> Quaternion:
    """Return the orientation as x, y, z, w."""
    q = message.pose.pose.orientation
    return q.x, q.y, q.z, q.w


def to_cascade_measurement(
    odom: Odometry, airspeed: TwistWithCovarianceStamped | None = None
) -> CascadeMeasurement | None:
    """Return the input of the cascade, or None while the estimate or its height is unknown."""
    if not has_estimate(odom.pose.covariance[0]) or is_height_lost(odom):
        return None
    return measure_motion(to_motion(odom, airspeed))


def to_control_inputs(
    odom: Odometry,
    airspeed: TwistWithCovarianceStamped | None,
    halves: tuple[PoseStamped | None, TwistStamped | None],
    armed: bool,
    must_land: bool,
    now_ns: int,
    dt: float,
) -> ControlInputs:
    """
    Return the controller's input.

    `halves` are those of the newest setpoint, `now_ns` is the time of the step, and `dt` the
    time since the last one. [s]
    """
    pose, velocity = halves
    motion = to_motion(odom, airspeed)
    blind = is_height_lost(odom)
    ready = has_estimate(odom.pose.covariance[0]) and not blind
    if pose is None or velocity is None:
        return ControlInputs(
            motion, ready, blind, False, FLOOR_SETPOINT, 0.0, armed, must_land, dt
        )
    # The older of the two messages counts
    age = max(stamp_age(from_stamp(half.header.stamp), now_ns) for half in (pose, velocity))
    setpoint = to_setpoint(pose, velocity)
    return ControlInputs(motion, ready, blind, True, setpoint, age, armed, must_land, dt)


def is_height_lost(odom: Odometry) -> bool:
    """Return whether an estimate has lost its height."""
    return not has_estimate(odom.pose.covariance[14])


def to_motion(odom: Odometry, airspeed: TwistWithCovarianceStamped | None) -> ControlMotion:
    """Return an estimate as input of a control law, with the velocity through the air."""
    p, w = odom.pose.pose.position, odom.twist.twist.angular
    velocity = to_air_velocity(odom, airspeed)
    return ControlMotion((p.x, p.y, p.z), to_attitude(odom), velocity, (w.x, w.y, w.z))


def to_setpoint(pose: PoseStamped, velocity: TwistStamped) -> Setpoint:
    """Return the navigator's setpoint."""
    q = pose.pose.orientation
    heading = yaw_from_quaternion((q.x, q.y, q.z, q.w))
    return Setpoint(pose.pose.position.z, heading, velocity.twist.linear.x)


def from_setpoint(stamp: Time, setpoint: Setpoint) -> tuple[PoseStamped, TwistStamped]:
    """Return the messages for heading and altitude, and for forward speed."""
    pose = create_message(PoseStamped)
    pose.header.stamp = stamp
    pose.header.frame_id = 'odom'
    pose.pose.position.z = setpoint.altitude
    q = pose.pose.orientation
    q.x, q.y, q.z, q.w = level_quaternion(setpoint.heading)
    velocity = create_message(TwistStamped)
    velocity.header.stamp = stamp
    velocity.header.frame_id = 'base_link'
    velocity.twist.linear.x = setpoint.speed
    return pose, velocity


def from_duties(stamp: Time, names: list[str], duties: tuple[float, ...]) -> ActuatorDuty:
    """Return the duties by actuator name, -1 to 1; unused slots are left out."""
    message = create_message(ActuatorDuty)
    message.header.stamp = stamp
    message.header.frame_id = 'base_link'
    message.name = names
    # rclpy accepts an array of the type without checking each item
    message.duty = array.array('d', duties[: len(names)])
    return message


def update_reserve_report(before: ReserveReport | None, step: InboxStep) -> ReserveReport | None:
    """
    Return the energy monitor's latest report, with the arrival of reserve and status.

    They are separate topics, so either may arrive a step after the other, or no longer.
    """
    reserve, status = step.last_message('energy/reserve'), step.last_message('energy/status')
    if reserve is None and status is None:
        return before
    # Until the first reserve message, assume that the reserve is reached: stay on the ground.
    now_ns = step.stamp_ns
    word = ReserveReport(now_ns, True, False, status_ns=now_ns) if before is None else before
    if status is not None:
        word = word._replace(
            urgent=status.level >= HealthLevel.ERROR, why=status.message, status_ns=now_ns
        )
    if reserve is not None:
        word = word._replace(reserve_ns=now_ns, reserve=reserve.data)
    return word


def to_lamp(message: PoseWithCovarianceStamped | None) -> LampPosition | None:
    """Return the lamp in the body frame, or None where it is not seen."""
    if message is None or not has_estimate(message.pose.covariance[0]):
        return None
    place, covariance = message.pose.pose.position, message.pose.covariance
    # xx, xy, yy of the row-major 6 x 6 matrix
    spread = float(covariance[0]), float(covariance[1]), float(covariance[7])
    return LampPosition(place.x, place.y, place.z, spread)


def to_diodes(message: LampPeaks | None) -> DiodeReadings:
    """Return axis and amplitude of each diode for the requested beacon, which is the first."""
    if message is None or not message.beacon:
        return (), ()
    if len(message.beacon[0].amplitude) != len(message.axis):
        return (), ()
    axes = tuple([(axis.x, axis.y) for axis in message.axis])
    if not all(map(math.isfinite, chain.from_iterable(axes))):
        return (), ()
    return axes, tuple(message.beacon[0].amplitude)


def to_sighting(
    lamp: PoseWithCovarianceStamped | None, peaks: LampPeaks | None, age: float
) -> LampSighting | None:
    """Return the lamp as the estimator uses it; `age` is the time since mid-block [s]."""
    if lamp is None or peaks is None:
        return None
    axes, amplitudes = to_diodes(peaks)
    return build_sighting(to_lamp(lamp), axes, amplitudes, to_frequencies(peaks), age)


def to_frequencies(message: LampPeaks) -> tuple[float, ...]:
    """Return the frequency of the requested beacon at each diode. [Hz]"""
    return tuple(message.beacon[0].frequency) if message.beacon else ()


def to_tracked(message: Odometry) -> TrackedMotion | None:
    """Return the motion by a tracker, or None where a number of it cannot be meant."""
    p, v, yaw = message.pose.pose.position, message.twist.twist.linear, _to_yaw(message)
    stamp_ns = from_stamp(message.header.stamp)
    # NaN compares false
    is_meant = all(abs(each) < FARTHEST_PLACE for each in (p.x, p.y, v.x, v.y))
    if not (is_meant and math.isfinite(yaw)):
        return None
    # The drone is level but for a few degrees
    return TrackedMotion(stamp_ns, (p.x, p.y), yaw, rotate((v.x, v.y), yaw))


def to_odom_motion(odom: Odometry, airspeed: TwistWithCovarianceStamped | None) -> OdomMotion:
    """Return the motion by the estimator."""
    p, v, yaw = odom.pose.pose.position, odom.twist.twist.linear, _to_yaw(odom)
    u = to_air_velocity(odom, airspeed)
    return OdomMotion(
        from_stamp(odom.header.stamp),
        (p.x, p.y),
        yaw,
        odom.twist.twist.angular.z,
        rotate((v.x, v.y), yaw),
        rotate((u[0], u[1]), yaw),
    )


def _to_yaw(message: Odometry) -> float:
    return yaw_from_quaternion(to_attitude(message))
