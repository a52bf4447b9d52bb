# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the messages that a vehicle publishes, simulated or real, from numbers."""

import array
from collections.abc import Sequence
import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Vector3Stamped
from lta_config.topics import load_topic_table
from lta_msgs.msg import LightBlock
from nav_msgs.msg import Odometry
import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import BatteryState, FluidPressure, Illuminance, Imu, Range
from std_msgs.msg import Header

NAN = float('nan')


def build_imu_message(
    stamp: Time,
    force: tuple[float, ...],
    rates: tuple[float, ...],
    noise: tuple[float, ...],
) -> Imu:
    """
    Return specific force [m/s2] and angular rate [rad/s] in body axes; no orientation (REP-145).

    `noise` holds the standard deviations of a sample without biases: three of force, three of
    rate.
    """
    message = Imu()
    message.header = _build_header(stamp, 'imu')
    # REP-145: -1 marks an orientation that is not provided
    message.orientation_covariance[0] = -1.0
    for axis in range(3):
        # Diagonal of a row-major 3 x 3 matrix
        message.linear_acceleration_covariance[4 * axis] = noise[axis] ** 2
        message.angular_velocity_covariance[4 * axis] = noise[3 + axis] ** 2
    a, w = message.linear_acceleration, message.angular_velocity
    a.x, a.y, a.z = force
    w.x, w.y, w.z = rates
    return message


def build_range_message(
    stamp: Time, distance: float, limits: tuple[float, float], field_of_view: float
) -> Range:
    """
    Return a downward distance [m]; +Inf is no return (REP-117).

    `limits`: shortest and longest distance [m]. `field_of_view`: full angle [deg].
    """
    message = Range()
    message.header = _build_header(stamp, 'range')
    message.radiation_type = Range.INFRARED
    message.field_of_view = math.radians(field_of_view)
    message.min_range, message.max_range = limits
    message.range = distance
    return message


def build_pressure_message(stamp: Time, value: float, deviation: float) -> FluidPressure:
    """Return the air pressure, with the square of its deviation as variance [Pa]."""
    message = FluidPressure()
    message.header = _build_header(stamp, 'pressure')
    message.fluid_pressure, message.variance = value, deviation * deviation
    return message


def build_light_block_message(stamp: Time, block: NDArray[np.uint16]) -> LightBlock:
    """Return an ADC block, shape (samples, diodes) [counts]."""
    return LightBlock(
        header=_build_header(stamp, 'photodiodes'),
        sample_rate=load_topic_table().light.sample_rate.si,
        diodes=block.shape[1],
        # rclpy accepts an array of the type as it is, and checks any other sequence item by item
        counts=array.array('H', block.astype(np.uint16, copy=False).tobytes()),
    )


def build_illuminance_message(stamp: Time, lux: float) -> Illuminance:
    """Return the light at the panel [lx]."""
    return Illuminance(header=_build_header(stamp, 'illuminance'), illuminance=lux)


def build_battery_state(
    stamp: Time, voltage: float, current: float, location: str
) -> BatteryState:
    """Return a voltage [V] and a current [A]; fields that a meter cannot measure are NaN."""
    return BatteryState(
        header=_build_header(stamp, location),
        voltage=voltage,
        current=current,
        temperature=NAN,
        charge=NAN,
        capacity=NAN,
        design_capacity=NAN,
        percentage=NAN,
        present=True,
        location=location,
    )


def build_odometry(stamp: Time, motion: Sequence[float]) -> Odometry:
    """
    Return pose in `map` and twist in the body frame.

    `motion` has 13 numbers: position [m], quaternion x y z w, velocity [m/s] and rates [rad/s].
    """
    message = Odometry()
    message.header = _build_header(stamp, 'ground_truth/odom')
    message.child_frame_id = 'base_link'
    pose, twist = message.pose.pose, message.twist.twist
    p, q, v, w = pose.position, pose.orientation, twist.linear, twist.angular
    p.x, p.y, p.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z = motion
    return message


def build_wind_message(stamp: Time, velocity: tuple[float, ...]) -> Vector3Stamped:
    """Return the velocity of the air in `map` [m/s]."""
    message = Vector3Stamped(header=_build_header(stamp, 'wind'))
    message.vector.x, message.vector.y, message.vector.z = velocity
    return message


def _build_header(stamp: Time, topic: str) -> Header:
    """Return a header in the frame that the topic table names."""
    header = Header()
    header.stamp, header.frame_id = stamp, load_topic_table().topics[topic].frame
    return header
