# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Convert motions, setpoints and duties to and from ROS messages."""

import array
from collections.abc import Iterable
from itertools import chain
import math
from typing import final

from builtin_interfaces.msg import Time
from geometry_msgs.msg import (
    PoseStamped,
    PoseWithCovarianceStamped,
    TwistStamped,
    TwistWithCovarianceStamped,
)
from lta_config.covariances import has_estimate
from lta_config.topics import TopicTable
from lta_control.flight_step import ControlInputs, TILT_LIMIT
from lta_control.guidance import GuidanceInputs, ReserveReport, ReserveResponseSettings
from lta_control.mission import MissionSettings
from lta_control.motion import (
    AirReckoning,
    CascadeMeasurement,
    ControlMotion,
    FLOOR_SETPOINT,
    has_overturned,
    level_quaternion,
    measure_motion,
    Quaternion,
    Setpoint,
    Vector,
    yaw_from_quaternion,
)
from lta_control.odometry.tracked_motion import (
    LocatedMotion,
    Locator,
    OdomMotion,
    rotate,
    TrackedMotion,
)
from lta_control.sighting import build_sight, LampPosition
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy
from lta_graph.health import HealthLevel, stamp_age
from lta_graph.lockstep import InboxStep
from lta_graph.ros.stamps import from_stamp, MessagePairing
from lta_msgs.msg import ActuatorDuty, LampPeaks
from nav_msgs.msg import Odometry

DiodeReadings = tuple[tuple[tuple[float, float], ...], tuple[float, ...]]

FARTHEST_PLACE = 1e4  # m from the origin, and m/s: beyond any hall


def to_air_velocity(odom: Odometry, airspeed: TwistWithCovarianceStamped | None) -> Vector:
    """
    Return the velocity through the air, body frame [m/s].

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
    pose = PoseStamped()
    pose.header.stamp = stamp
    pose.header.frame_id = 'odom'
    pose.pose.position.z = setpoint.altitude
    q = pose.pose.orientation
    q.x, q.y, q.z, q.w = level_quaternion(setpoint.heading)
    velocity = TwistStamped()
    velocity.header.stamp = stamp
    velocity.header.frame_id = 'base_link'
    velocity.twist.linear.x = setpoint.speed
    return pose, velocity


def from_duties(stamp: Time, names: list[str], duties: tuple[float, ...]) -> ActuatorDuty:
    """Return the duties by actuator name, -1 to 1; unused slots are left out."""
    message = ActuatorDuty()
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


@final
class GuidanceReader:
    """
    Collect what a setpoint is chosen from, over the steps of the navigator.

    `table` has the periods of light blocks and estimates, `scale` is that of `build_sight`.

    Attributes
    ----------
    tracked : TrackedMotion or None
        The newest pose by a tracker that no step has used.
    is_started : bool
        Whether an estimate has come.
    has_overturned : bool
        Whether the drone has overturned by the newest estimate.

    """

    def __init__(self, table: TopicTable, scale: float) -> None:
        self._block_ns, self._scale = table['photodiodes'].period_ns, scale
        # Three blocks of estimates: the light of a block arrives after its end
        self._reckoning = AirReckoning(table.control_ns, 3 * self._block_ns // table.control_ns)
        self._airspeeds = MessagePairing()
        self._measured: CascadeMeasurement | None = None
        self._locator = Locator()
        self._located: LocatedMotion | None = None
        self._report: ReserveReport | None = None  # None: stay on the ground
        self.tracked: TrackedMotion | None = None
        self.is_started = self.has_overturned = False

    def read_step(
        self,
        step: InboxStep,
        settings: MissionSettings,
        reserve: ReserveResponseSettings,
        strategy: NavigationStrategy,
    ) -> GuidanceInputs:
        """Return what the setpoint of a step is chosen from."""
        stamped = self._airspeeds.pair_messages(step.valid['odom'], step.valid['airspeed'])
        self._reckoning.add_motions(to_air_motions(stamped))
        if stamped:
            _, odom, airspeed = stamped[-1]
            self._measured = to_cascade_measurement(odom, airspeed)
            self._located = self._locator.locate(to_odom_motion(odom, airspeed), self.tracked)
            self.tracked, self.is_started = None, True
            self.has_overturned = has_overturned(to_attitude(odom), math.cos(TILT_LIMIT))
        self._report = update_reserve_report(self._report, step)
        return GuidanceInputs(
            settings,
            reserve,
            strategy,
            step.stamp_ns,
            self._build_sight(step),
            self._measured,
            self._report,
            self._located,
        )

    def _build_sight(self, step: InboxStep) -> LightMeasurement:
        """Return the light with the drone's motion at the middle of its block."""
        # A block is stamped with its first sample; the bearing is that of its middle
        then = self._reckoning.find_nearest(step.stamp_ns + self._block_ns // 2)
        axes, amplitudes = to_diodes(step.last_valid('light/peaks'))
        lamp, interval = to_lamp(step.last_valid('light/estimate')), self._block_ns * 1e-9
        return build_sight(lamp, axes, amplitudes, then, interval, self._scale)
