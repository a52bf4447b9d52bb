"""
Round values as ROS messages do, so that the one-process loop matches the graph.

A message carries a heading as a quaternion, a climb rate as a velocity along body z, and a range
in 32 bits. The round trip changes the last bits, which floor contact amplifies to millimetres. A
loop that must reproduce the graph's flight passes its values through these functions.
"""

from collections.abc import Sequence
import math

from lta_control.attitude import Quaternion, up_in_body, Vector, yaw_from_quaternion
from lta_control.cascade import CascadeMeasurement, Setpoint
from lta_control.estimator import MotionEstimate
from lta_control.odometry.ground_state import GroundMotion
import numpy as np

LEVEL = 0.1  # cosine of the tilt below which climb and heave are not separated


def round_to_float32(value: float) -> float:
    """Return a number rounded to a float32 field."""
    return float(np.float32(value))


def mask_out_of_range(distance: float, nearest: float, farthest: float) -> float:
    """Return a distance, or NaN outside the sensor's range (REP-117). [m]"""
    return distance if nearest <= distance <= farthest else math.nan


def newest_range(ranges: Sequence[tuple[int, float]], reach: tuple[float, float]) -> float:
    """
    Return the newest range as in its message, or NaN if there is none. [m]

    `ranges` holds stamps [ns] and distances, `reach` the limits of the sensor.
    """
    if not ranges:
        return math.nan
    # A Range message holds distance and limits in single precision
    nearest, farthest = map(round_to_float32, reach)
    return mask_out_of_range(round_to_float32(ranges[-1][1]), nearest, farthest)


def round_heading(setpoint: Setpoint) -> Setpoint:
    """Return a setpoint whose heading has been a quaternion."""
    return setpoint._replace(heading=yaw_from_quaternion(level_quaternion(setpoint.heading)))


def level_quaternion(yaw: float) -> Quaternion:
    """Return the attitude of a level vehicle with a heading. [rad]"""
    return 0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)


def air_relative_velocity(estimate: MotionEstimate) -> Vector:
    """Return the air-relative body velocity that matches the estimated climb rate. [m/s]"""
    ux, uy, uz = up_in_body(estimate.attitude)
    surge, sway = estimate.airspeed.surge, estimate.airspeed.sway
    climb = estimate.altitude.climb
    # Solve climb = up . velocity for the heave
    return surge, sway, (climb - (ux * surge + uy * sway)) / uz if uz > LEVEL else climb


def ground_velocity(estimate: MotionEstimate, ground: GroundMotion) -> Vector:
    """Return the velocity over ground in the body frame. [m/s]"""
    x, y, z, w = estimate.attitude
    vx, vy = ground.velocity
    vz = estimate.altitude.climb
    # Transposed rotation matrix of the attitude, which is body to odom
    return (
        (1.0 - 2.0 * (y * y + z * z)) * vx
        + 2.0 * (x * y + z * w) * vy
        + 2.0 * (x * z - y * w) * vz,
        2.0 * (x * y - z * w) * vx
        + (1.0 - 2.0 * (x * x + z * z)) * vy
        + 2.0 * (y * z + x * w) * vz,
        2.0 * (x * z + y * w) * vx
        + 2.0 * (y * z - x * w) * vy
        + (1.0 - 2.0 * (x * x + y * y)) * vz,
    )


def build_measurement(
    attitude: Quaternion, altitude: float, speed: Vector, rates: Vector
) -> CascadeMeasurement:
    """
    Return the input of the cascade.

    Parameters
    ----------
    attitude : tuple
        Body to odom, x y z w.
    altitude : float
        Of the hull centre above the floor. [m]
    speed : tuple
        Air-relative velocity, body frame. [m/s]
    rates : tuple
        About the body axes. [rad/s]

    """
    ux, uy, uz = up_in_body(attitude)
    return CascadeMeasurement(
        altitude=altitude,
        climb=ux * speed[0] + uy * speed[1] + uz * speed[2],
        heading=yaw_from_quaternion(attitude),
        yaw_rate=rates[2],
        speed=speed[0],
        sway=speed[1],
        pitch_rate=rates[1],
    )
