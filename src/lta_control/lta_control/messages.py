"""Estimates, setpoints and duties as ROS messages, and back."""

import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TwistStamped
from lta_control import message_rounding
from lta_control.attitude import Quaternion, up_in_body, yaw_from_quaternion
from lta_control.cascade import CascadeMeasurement, Setpoint
from lta_control.estimator import EstimatorInputs, MotionEstimate
from lta_control.laws.protocol import ControlMotion
from lta_control.per_rotor import pad_to_slots, PerRotor
from lta_control.reserve import ReserveReport
from lta_control.sighting import DeadReckonedMotion, LampPosition
from lta_graph.health import HealthLevel
from lta_graph.inbox import InboxStep
from lta_graph.ros.message_validation import find_fault
from nav_msgs.msg import Odometry
import numpy as np
from sensor_msgs.msg import FluidPressure, Imu, JointState, PointCloud2, Range

BAROMETER = 30e3, 125e3  # Pa, the range of the BMP388
FASTEST_TURN = math.radians(3000.0)  # rad/s; the BMI088 measures 2000 deg/s
HARDEST_PULL = 400.0  # m/s2; it measures 24 g
FARTHEST = 100.0  # m; whatever a message says, no range finder of a small drone looks farther
UNKNOWN = -1.0  # in the first element of a covariance: the field is not known (REP-145's habit)
ROW = ('x', 'y', 'amplitude')  # what is read of a diode's point
DRIFT = 0.1  # of dead-reckoned position [m/s]: an assumption
START_SIGMA = 0.01  # of the origin that the position counts from [m]: an assumption
YAW_DRIFT = 1e-3  # of heading after the rest at the start [rad/s]: an assumption
SPEED_SIGMA = 0.1  # of the airspeed [m/s]: an assumption, checked by the report


def to_inputs(step: InboxStep, commanded: PerRotor) -> EstimatorInputs:
    """Return what the estimator takes from one step's messages; the newest of each counts."""
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
    """Return a distance, NaN where it is outside the sensor's reach (REP-117). [m]"""
    farthest = min(message.max_range, FARTHEST)
    return message_rounding.mask_out_of_range(float(message.range), message.min_range, farthest)


def to_pressure(message: FluidPressure) -> float:
    """Return a pressure, NaN where there is no such air to fly in. [Pa]"""
    return message_rounding.mask_out_of_range(message.fluid_pressure, *BAROMETER)


def is_plausible(inputs: EstimatorInputs) -> bool:
    """Tell whether an IMU can have felt this: one wrong sample would be in attitude for good."""
    turning = all(abs(rate) <= FASTEST_TURN for rate in inputs.rates)
    return turning and all(abs(force) <= HARDEST_PULL for force in inputs.force)


def to_duties(motors: JointState | None, names: list[str], before: PerRotor) -> PerRotor:
    """Return the commanded duties by slot; those before where nothing fitting has come."""
    return (
        before
        if motors is None or not is_valid_command(motors, names)
        else pad_to_slots(motors.effort)
    )


def is_valid_command(motors: JointState, names: list[str]) -> bool:
    """Tell whether duties are those of a vehicle's rotors, each from -1 to 1."""
    ours = list(motors.name) == names and len(motors.effort) == len(names)
    return ours and all(-1.0 <= duty <= 1.0 for duty in motors.effort)  # NaN compares false


def from_estimate(stamp: Time, estimate: MotionEstimate) -> Odometry:
    """Return the estimate; covariance[0] is -1 while the estimator still learns its biases."""
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
        pose_covariance[0] = pose_covariance[7] = START_SIGMA**2 + (DRIFT * estimate.flown) ** 2
        pose_covariance[14] = estimate.altitude.p[0]
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


def to_measurement(message: Odometry) -> CascadeMeasurement | None:
    """Return what the cascade acts on, or None while the estimate is unknown."""
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
    """Return an estimate as control laws see it."""
    p = message.pose.pose.position
    v, w = message.twist.twist.linear, message.twist.twist.angular
    return ControlMotion((p.x, p.y, p.z), to_attitude(message), (v.x, v.y, v.z), (w.x, w.y, w.z))


def is_level(message: Odometry, limit: float) -> bool:
    """Tell whether the vehicle tilts less than an angle. [rad]."""
    return up_in_body(to_attitude(message))[2] >= math.cos(limit)


def to_setpoint(pose: PoseStamped, velocity: TwistStamped) -> Setpoint:
    """Return what the navigator asks for."""
    q = pose.pose.orientation
    return message_rounding.build_setpoint(
        pose.pose.position.z, (q.x, q.y, q.z, q.w), velocity.twist.linear.x
    )


def from_setpoint(stamp: Time, setpoint: Setpoint) -> tuple[PoseStamped, TwistStamped]:
    """Return heading and altitude, and forward speed."""
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
    """Return duties by actuator name, -1 to 1; slots without an actuator are left out."""
    message = JointState()
    message.header.stamp = stamp
    message.header.frame_id = 'base_link'
    message.name = names
    message.effort = list(duties[: len(names)])
    return message


def to_dead_reckoning(message: Odometry) -> DeadReckonedMotion:
    """Return how the drone takes itself to move."""
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
    told = None if status is None or not status.status else status.status[0]
    if reserve is None and told is None:
        return before
    # Until the first reserve message, assume that the reserve is reached: stay on the ground.
    word = ReserveReport(step.stamp_ns, True, False) if before is None else before
    if told is not None:
        word = word._replace(urgent=told.level >= bytes([HealthLevel.ERROR]), why=told.message)
    if reserve is not None:
        word = word._replace(stamp_ns=step.stamp_ns, reserve=reserve.data)
    return word


def to_lamp(message: PoseWithCovarianceStamped) -> LampPosition | None:
    """Return the lamp in the body frame, None where it is not seen."""
    place, covariance = message.pose.pose.position, message.pose.covariance
    if covariance[0] == UNKNOWN or find_fault(message):
        return None
    spread = float(covariance[0]), float(covariance[1]), float(covariance[7])
    return LampPosition(place.x, place.y, place.z, spread)


def to_diodes(
    message: PointCloud2 | None,
) -> tuple[tuple[tuple[float, float], ...], tuple[float, ...]]:
    """
    Return axis and amplitude of each diode for the beacon that is wanted.

    It is the first row of the cloud; those of other beacons follow. A cloud that does not hold
    what it declares is as good as none.
    """
    if message is None or message.width == 0 or message.height == 0 or find_fault(message):
        return (), ()
    places = {field.name: field.offset // 4 for field in message.fields}
    known = all(4 * places.get(name, math.inf) < message.point_step for name in ROW)
    if not known or message.point_step % 4:
        return (), ()
    words = np.frombuffer(message.data, dtype='<f4').reshape(-1, message.point_step // 4)
    row = words[: message.width]
    if not np.isfinite(row[:, [places['x'], places['y']]]).all():
        return (), ()
    axes = tuple((x, y) for x, y in row[:, [places['x'], places['y']]].tolist())
    return axes, tuple(row[:, places['amplitude']].tolist())
