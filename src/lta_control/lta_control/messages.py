"""Convert estimates, setpoints and duties to and from ROS messages."""

import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TwistStamped
from lta_control import message_rounding
from lta_control.attitude import Quaternion, yaw_from_quaternion
from lta_control.cascade import CascadeMeasurement, Setpoint
from lta_control.control import has_overturned
from lta_control.estimator import EstimatorInputs, MotionEstimate
from lta_control.laws.protocol import ControlMotion
from lta_control.per_rotor import pad_to_slots, PerRotor
from lta_control.reserve import ReserveReport
from lta_control.sighting import DeadReckonedMotion, LampPosition
from lta_graph.health import HealthLevel
from lta_graph.inbox import InboxStep
from nav_msgs.msg import Odometry
import numpy as np
from sensor_msgs.msg import FluidPressure, Imu, JointState, PointCloud2, Range

BAROMETER = 30e3, 125e3  # Pa, the range of the BMP388
FASTEST_TURN = math.radians(3000.0)  # rad/s; the BMI088 measures 2000 deg/s
HARDEST_PULL = 400.0  # m/s2; it measures 24 g
FARTHEST = (
    100.0  # m; upper bound for the range finder of a small drone, whatever the message declares
)
UNKNOWN = -1.0  # in the first element of a covariance: the field is unknown (as in REP-145)
ROW = ('x', 'y', 'amplitude')  # fields read from a diode's point
DRIFT = 0.1  # of the dead-reckoned position [m/s]: an assumption
START_SIGMA = 0.01  # of the origin of the position [m]: an assumption
YAW_DRIFT = 1e-3  # of the heading after the calibration [rad/s]: an assumption
SPEED_SIGMA = 0.1  # of the airspeed [m/s]: an assumption, checked by the report


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
    farthest = min(message.max_range, FARTHEST)
    return message_rounding.mask_out_of_range(float(message.range), message.min_range, farthest)


def to_pressure(message: FluidPressure) -> float:
    """Return a pressure, or NaN outside the barometer's range. [Pa]"""
    return message_rounding.mask_out_of_range(message.fluid_pressure, *BAROMETER)


def is_plausible_imu_sample(inputs: EstimatorInputs) -> bool:
    """Return whether an IMU sample is physically possible."""
    # One implausible sample would corrupt the attitude for the rest of the flight.
    turning = all(abs(rate) <= FASTEST_TURN for rate in inputs.rates)
    return turning and all(abs(force) <= HARDEST_PULL for force in inputs.force)


def to_duties(motors: JointState | None, names: list[str], before: PerRotor) -> PerRotor:
    """Return the commanded duties by slot, or `before` without a valid command."""
    return (
        before
        if motors is None or not is_valid_command(motors, names)
        else pad_to_slots(motors.effort)
    )


def is_valid_command(motors: JointState, names: list[str]) -> bool:
    """Return whether the duties belong to the vehicle's rotors and are from -1 to 1."""
    ours = list(motors.name) == names and len(motors.effort) == len(names)
    return ours and all(-1.0 <= duty <= 1.0 for duty in motors.effort)  # NaN compares false


def from_estimate(stamp: Time, estimate: MotionEstimate) -> Odometry:
    """Return the estimate as a message; covariance[0] is -1 while the biases are calibrated."""
    message = Odometry()
    message.header.stamp = stamp
    message.header.frame_id = 'odom'
    message.child_frame_id = 'base_link'
    pose, twist = message.pose.pose, message.twist.twist
    p, q = pose.position, pose.orientation
    p.x, p.y = estimate.position
    p.z = estimate.altitude.height
    q.x, q.y, q.z, q.w = estimate.attitude
    v, w = twist.linear, twist.angular
    v.x, v.y, v.z = message_rounding.air_relative_velocity(estimate)
    w.x, w.y, w.z = estimate.rates
    pose_covariance = np.zeros(36)
    twist_covariance = np.zeros(36)
    if not estimate.ready:
        pose_covariance[0] = twist_covariance[0] = UNKNOWN
    else:
        # Row-major 6 x 6, order x y z roll pitch yaw: diagonal at 0, 7, 14, 21, 28, 35
        pose_covariance[0] = pose_covariance[7] = START_SIGMA**2 + (DRIFT * estimate.flown) ** 2
        pose_covariance[14] = estimate.altitude.p[0]
        # [rad2] Roll and pitch are bounded by gravity; yaw drifts with the gyroscope
        pose_covariance[21] = pose_covariance[28] = 0.02**2
        pose_covariance[35] = (YAW_DRIFT * estimate.flown) ** 2
        twist_covariance[0] = twist_covariance[7] = SPEED_SIGMA**2
        twist_covariance[14] = estimate.altitude.p[3]
        twist_covariance[21] = twist_covariance[28] = twist_covariance[35] = 1e-4
    message.pose.covariance = pose_covariance
    message.twist.covariance = twist_covariance
    return message


def to_attitude(message: Odometry) -> Quaternion:
    """Return the orientation as x, y, z, w."""
    q = message.pose.pose.orientation
    return q.x, q.y, q.z, q.w


def to_cascade_measurement(message: Odometry) -> CascadeMeasurement | None:
    """Return the input of the cascade, or None while the estimate is unknown."""
    if message.pose.covariance[0] == UNKNOWN:
        return None
    linear, angular = message.twist.twist.linear, message.twist.twist.angular
    return message_rounding.build_measurement(
        to_attitude(message),
        message.pose.pose.position.z,
        (linear.x, linear.y, linear.z),
        (angular.x, angular.y, angular.z),
    )


def to_motion(message: Odometry) -> ControlMotion:
    """Return an estimate as input of a control law."""
    p = message.pose.pose.position
    v, w = message.twist.twist.linear, message.twist.twist.angular
    return ControlMotion((p.x, p.y, p.z), to_attitude(message), (v.x, v.y, v.z), (w.x, w.y, w.z))


def is_overturned(message: Odometry, limit: float) -> bool:
    """Return whether the vehicle tilts more than a limit [rad]; False if its attitude is NaN."""
    return has_overturned(to_attitude(message), math.cos(limit))


def to_setpoint(pose: PoseStamped, velocity: TwistStamped) -> Setpoint:
    """Return the navigator's setpoint."""
    q = pose.pose.orientation
    return message_rounding.build_setpoint(
        pose.pose.position.z, (q.x, q.y, q.z, q.w), velocity.twist.linear.x
    )


def from_setpoint(stamp: Time, setpoint: Setpoint) -> tuple[PoseStamped, TwistStamped]:
    """Return the messages for heading and altitude, and for forward speed."""
    pose = PoseStamped()
    pose.header.stamp = stamp
    pose.header.frame_id = 'odom'
    pose.pose.position.z = setpoint.altitude
    q = pose.pose.orientation
    q.x, q.y, q.z, q.w = message_rounding.level_quaternion(setpoint.heading)
    velocity = TwistStamped()
    velocity.header.stamp = stamp
    velocity.header.frame_id = 'base_link'
    velocity.twist.linear.x = setpoint.speed
    return pose, velocity


def from_duties(stamp: Time, names: list[str], duties: tuple[float, ...]) -> JointState:
    """Return the duties by actuator name, -1 to 1; unused slots are left out."""
    message = JointState()
    message.header.stamp = stamp
    message.header.frame_id = 'base_link'
    message.name = names
    message.effort = list(duties[: len(names)])
    return message


def to_dead_reckoning(message: Odometry) -> DeadReckonedMotion:
    """Return the drone's dead-reckoned motion."""
    place, speed = message.pose.pose.position, message.twist.twist.linear
    return DeadReckonedMotion(
        yaw_from_quaternion(to_attitude(message)), place.x, place.y, speed.x, speed.y
    )


def update_reserve_report(before: ReserveReport | None, step: InboxStep) -> ReserveReport | None:
    """
    Return the energy monitor's latest report, stamped when its reserve message came.

    The reserve and the status are separate topics, so either may arrive a step after the other.
    """
    reserve, status = step.last_message('energy/reserve'), step.last_message('energy/status')
    latest = None if status is None or not status.status else status.status[0]
    if reserve is None and latest is None:
        return before
    # Until the first reserve message, assume that the reserve is reached: stay on the ground.
    word = ReserveReport(step.stamp_ns, True, False) if before is None else before
    if latest is not None:
        word = word._replace(urgent=latest.level >= bytes([HealthLevel.ERROR]), why=latest.message)
    if reserve is not None:
        word = word._replace(stamp_ns=step.stamp_ns, reserve=reserve.data)
    return word


def to_lamp(message: PoseWithCovarianceStamped | None) -> LampPosition | None:
    """Return the lamp in the body frame, or None where it is not seen."""
    if message is None or message.pose.covariance[0] == UNKNOWN:
        return None
    place, covariance = message.pose.pose.position, message.pose.covariance
    # xx, xy, yy of the row-major 6 x 6 matrix
    spread = float(covariance[0]), float(covariance[1]), float(covariance[7])
    return LampPosition(place.x, place.y, place.z, spread)


def to_diodes(
    message: PointCloud2 | None,
) -> tuple[tuple[tuple[float, float], ...], tuple[float, ...]]:
    """
    Return axis and amplitude of each diode for the requested beacon.

    Its points are the first row of the cloud; other beacons follow. A cloud without the fields
    counts as empty.
    """
    if message is None or message.width == 0 or message.height == 0:
        return (), ()
    # All fields are float32: index of each field in a point
    places = {field.name: field.offset // 4 for field in message.fields}
    known = all(4 * places.get(name, math.inf) < message.point_step for name in ROW)
    if not known or message.point_step % 4:
        return (), ()
    words = np.frombuffer(message.data, dtype='<f4').reshape(-1, message.point_step // 4)
    row = words[: message.width]
    if not np.isfinite(row[:, [places['x'], places['y']]]).all():
        return (), ()
    axes = tuple(map(tuple, row[:, [places['x'], places['y']]].tolist()))
    return axes, tuple(row[:, places['amplitude']].tolist())
