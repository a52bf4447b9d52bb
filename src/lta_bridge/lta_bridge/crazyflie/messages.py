"""Convert Crazyflie readings to ROS messages, and ROS messages to bridge commands."""

from collections.abc import Sequence
import math
from typing import NamedTuple, Self

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, TwistStamped
from lta_bridge.crazyflie.bridge_core import CrazyflieCommand, PositionEstimate
from lta_bridge.crazyflie.readings import AirReading, ImuReading
from lta_config.covariances import has_estimate
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_control.attitude import yaw_from_quaternion
from lta_control.cascade import wrap_angle
from lta_control.messages import is_height_lost, to_attitude, to_setpoint
from lta_graph.ros.stamps import from_stamp
from lta_model import messages
from lta_model.electrical.loads import LoadModel, power_at_duty
from lta_model.sensors.imu import error_bounds, ImuSettings
from lta_model.sensors.pressure import PressureSettings
from lta_model.sensors.range import RangeSettings
from lta_msgs.msg import ActuatorDuty
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, FluidPressure, Imu, Range


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
        Return the current into the cell, negative because it discharges. [A]

        `duties`: duty of each motor, 0 to 1. `voltage`: cell voltage under this load, above 0 [V].
        """
        rotors = sum(power_at_duty(duty, voltage, self.offset, self.slope) for duty in duties)
        return -(self.electronics + rotors) / voltage


ATTITUDE_SIGMA = 0.05  # rad, assumed for the firmware's attitude: it reports no covariance
IMU_NOISE = error_bounds(ImuSettings()).noise
RANGE_SETTINGS = RangeSettings()


def to_imu(
    stamp: Time, motion: ImuReading, attitude: tuple[float, float, float, float] | None
) -> Imu:
    """Return the IMU message, with the attitude (x y z w) if it is known."""
    message = messages.build_imu_message(stamp, motion.force, motion.rates, IMU_NOISE)
    if attitude is not None:
        q = message.orientation
        q.x, q.y, q.z, q.w = attitude
        for axis in range(3):
            message.orientation_covariance[4 * axis] = ATTITUDE_SIGMA**2
    return message


def to_range_pressure(stamp: Time, felt: AirReading) -> tuple[Range, FluidPressure]:
    """Return the range and the pressure message."""
    return (
        messages.build_range_message(stamp, felt.distance, RANGE_SETTINGS),
        messages.build_pressure_message(stamp, felt.pressure, PressureSettings().noise),
    )


def to_battery(stamp: Time, voltage: float, current: float) -> BatteryState:
    """Return the battery message from the measured voltage [V] and the modeled current [A]."""
    return messages.build_battery_state(stamp, voltage, current, 'battery')


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
