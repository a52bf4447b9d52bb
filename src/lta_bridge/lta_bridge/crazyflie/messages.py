# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Convert Crazyflie readings to ROS messages, and ROS messages to commands and positions."""

from collections.abc import Sequence
import math
from typing import Any, final, NamedTuple, Self

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, PoseStamped, TwistStamped
from lta_bridge.crazyflie.bridge_core import (
    BridgeCore,
    CrazyflieCommand,
    PositionEstimate,
    StampedReading,
)
from lta_bridge.crazyflie.readings import AirReading, ImuReading, PowerReading
from lta_config.covariances import has_estimate
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_control.messages import is_height_lost, to_attitude, to_setpoint
from lta_control.motion import wrap_angle, yaw_from_quaternion
from lta_graph.health import HealthLevel
from lta_graph.ros import vehicle_messages
from lta_graph.ros.command_mux import CommandMux
from lta_graph.ros.message_validation import find_fault
from lta_graph.ros.node import GraphNode
from lta_graph.ros.publisher_conflict import CommanderWatch
from lta_graph.ros.stamps import from_stamp, to_stamp
from lta_model.electrical.loads import LoadModel, power_at_duty
from lta_model.sensors.imu import error_bounds, ImuSettings
from lta_model.sensors.pressure import PressureSettings
from lta_model.sensors.range import RangeSettings
from lta_msgs.msg import ActuatorDuty
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu


class CrazyfliePowerModel(NamedTuple):
    """Power of the electronics [W]; of a rotor: offset at zero thrust [W], slope [W/N]."""

    electronics: float
    offset: float
    slope: float

    @classmethod
    def from_energy(cls, energy: EnergyBlock) -> Self:
        """Return the model of a vehicle file, with radio and light board on."""
        loads, sensing = LoadModel.from_energy(energy), energy.loads.sensing
        board = 0.0 if sensing is None else sensing.si
        return cls(loads.idle + loads.transmitting + board, loads.rotor_offset, loads.rotor_slope)

    def cell_current(self, duties: Sequence[float], voltage: float) -> float:
        """
        Return the current into the cell, negative because it discharges [A].

        `duties`: duty of each motor, 0 to 1. `voltage`: cell voltage under this load, above 0 [V].
        """
        rotors = sum(power_at_duty(duty, voltage, self.offset, self.slope) for duty in duties)
        return -(self.electronics + rotors) / voltage


ATTITUDE_SIGMA = 0.05  # rad, assumed for the firmware's attitude: it reports no covariance
IMU_NOISE = error_bounds(ImuSettings()).noise
RANGE_LIMITS = RangeSettings().minimum, RangeSettings().maximum  # m
FIELD_OF_VIEW = RangeSettings().field_of_view  # deg


def to_imu(
    stamp: Time, motion: ImuReading, attitude: tuple[float, float, float, float] | None
) -> Imu:
    """Return the IMU message, with the attitude (x y z w) if it is known."""
    message = vehicle_messages.build_imu_message(stamp, motion.force, motion.rates, IMU_NOISE)
    if attitude is not None:
        q = message.orientation
        q.x, q.y, q.z, q.w = attitude
        for axis in range(3):
            message.orientation_covariance[4 * axis] = ATTITUDE_SIGMA**2
    return message


def from_reading(
    stamped: StampedReading, bridge: BridgeCore, consumption: CrazyfliePowerModel
) -> dict[str, Any]:
    """Return the messages of a reading by topic."""
    stamp = to_stamp(stamped.stamp_ns)
    match stamped.reading:
        case ImuReading() as motion:
            return {'imu': to_imu(stamp, motion, bridge.attitude)}
        case AirReading() as felt:
            noise = PressureSettings().noise
            return {
                'range': vehicle_messages.build_range_message(
                    stamp, felt.distance, RANGE_LIMITS, FIELD_OF_VIEW
                ),
                'pressure': vehicle_messages.build_pressure_message(stamp, felt.pressure, noise),
            }
        case PowerReading() as power if (motors := bridge.motors) and power.voltage > 0.0:
            # The Crazyflie has no current sensor: estimate the current from the duties
            current = consumption.cell_current(motors.duties, power.voltage)
            battery = vehicle_messages.build_battery_state(
                stamp, power.voltage, current, 'battery'
            )
            return {'battery': battery}
    return {}


def to_duties_command(message: ActuatorDuty, names: list[str], stamp_ns: int) -> CrazyflieCommand:
    """Return the duties by rotor; empty if the rotor names differ."""
    fits = list(message.name) == names and len(message.duty) == len(names)
    return CrazyflieCommand(stamp_ns, duties=tuple(message.duty) if fits else ())


def to_hover_command(
    pose: PoseStamped, velocity: TwistStamped, odom: Odometry, stamp_ns: int
) -> CrazyflieCommand:
    """Return speed, height and the heading error against the estimator's heading."""
    setpoint = to_setpoint(pose, velocity)
    turn = wrap_angle(setpoint.heading - yaw_from_quaternion(to_attitude(odom)))
    return CrazyflieCommand(stamp_ns, speed=setpoint.speed, turn=turn, height=setpoint.altitude)


def to_position(odom: Odometry) -> PositionEstimate | None:
    """Return height and distance from the start; None while calibrating, NaN for a lost height."""
    if not has_estimate(odom.pose.covariance[0]):
        return None
    p = odom.pose.pose.position
    height = math.nan if is_height_lost(odom) else p.z
    return PositionEstimate(height, math.hypot(p.x, p.y), from_stamp(odom.header.stamp))


@final
class CommandReader:
    """
    Hand setpoints and positions of the graph to a bridge, and say who else commands the drone.

    Parameters
    ----------
    node : GraphNode
        Its subscriptions bring them.
    bridge : BridgeCore
        Gets them.
    permits_rivals : bool
        Whether unknown nodes may command the drone.

    Attributes
    ----------
    helm : CommandMux
        Whose setpoints are followed.

    """

    def __init__(self, node: GraphNode, bridge: BridgeCore, permits_rivals: bool) -> None:
        self._health, self._permits_rivals = node.health, permits_rivals
        self._commanders = CommanderWatch(node, node.table)
        self._bridge, self._late_ns = bridge, node.table['setpoint/velocity'].latency_ns
        self._pose: PoseStamped | None = None
        self._velocity: TwistStamped | None = None
        self._odom: Odometry | None = None
        self._tracked_start: Point | None = None
        for name, callback in (
            ('odom', self._on_odom),
            ('ground_truth/odom', self._on_tracked_odom),
            ('setpoint/pose', self._on_pose),
            ('setpoint/velocity', self._on_velocity),
        ):
            node.subscribe_topic(name, callback)
        self.helm = CommandMux(node, self._accept_setpoint)

    def find_target_height(self) -> float:
        """Return the height of the newest setpoint; infinite without one [m]."""
        pose, _ = self.helm.select_setpoint(self._pose, self._velocity)
        return math.inf if pose is None else float(pose.pose.position.z)

    def find_rivals(self) -> None:
        """Look for unknown nodes that publish commands, and report them."""
        strangers = self._commanders.find_strangers()
        self._bridge.rivals = '' if self._permits_rivals else strangers
        if strangers:
            level = HealthLevel.WARN if self._permits_rivals else HealthLevel.ERROR
            self._health.report('commanders', level, strangers)
        elif 'commanders' in self._health:
            text = 'only the nodes of the flight command the drone'
            self._health.report('commanders', HealthLevel.OK, text)

    def _on_odom(self, odom: Odometry) -> None:
        # Invalid: the previous estimate stays, and ages
        where = None if find_fault(odom) else to_position(odom)
        if where is not None:
            self._odom = odom
            self._bridge.update_position(where)

    def _on_tracked_odom(self, odom: Odometry) -> None:
        # Of a tracker, for the limits of height and distance only; nothing is controlled by it
        if find_fault(odom):
            return
        here = odom.pose.pose.position
        if self._tracked_start is None:
            self._tracked_start = here
        start = self._tracked_start
        distance = math.hypot(here.x - start.x, here.y - start.y)
        stamp = from_stamp(odom.header.stamp)
        self._bridge.update_tracked_position(PositionEstimate(here.z, distance, stamp))

    def _on_pose(self, pose: PoseStamped) -> None:
        self._pose = pose

    def _on_velocity(self, velocity: TwistStamped) -> None:
        self._velocity = velocity
        self._accept_setpoint()

    def _accept_setpoint(self) -> None:
        """Send a setpoint to the core; the navigator's age counts from the end of its block."""
        pose, velocity = self.helm.select_setpoint(self._pose, self._velocity)
        # A hover command needs height and heading of the setpoint, and the estimated heading
        if self._bridge.command != 'setpoint' or not (pose and velocity and self._odom):
            return
        # The older half determines the age of the command
        oldest = min(from_stamp(pose.header.stamp), from_stamp(velocity.header.stamp))
        late = 0 if self.helm.held else self._late_ns
        self._bridge.accept_command(to_hover_command(pose, velocity, self._odom, oldest + late))
