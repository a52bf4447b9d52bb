"""
What becomes of a number on its way through a message of the graph.

A message carries a heading as a quaternion, a climb as the velocity along body z, a bearing as a
point and a distance as a float32, and each of these rounds. A loop in one process sends no
messages but does the same arithmetic, so that it agrees with the graph to the last bit.
"""

import math
import struct

from lta_control.airspeed import Airspeed
from lta_control.attitude import heading, Quaternion, up_in_body
from lta_control.cascade import Measured, Setpoint
from lta_control.estimator import Estimate

LEVEL = 0.1  # cosine of the tilt below which climb and heave are not told apart

_SINGLE = struct.Struct('f')


def single(value: float) -> float:
    """Return a number as a float32 field gives it back."""
    return float(_SINGLE.unpack(_SINGLE.pack(value))[0])


def heave(attitude: Quaternion, airspeed: Airspeed, climb: float) -> float:
    """Return the velocity along body z that goes with a climb rate. [m/s]"""
    ux, uy, uz = up_in_body(attitude)
    sideways = ux * airspeed.surge + uy * airspeed.sway
    return (climb - sideways) / uz if uz > LEVEL else climb


def climb(attitude: Quaternion, surge: float, sway: float, heave: float) -> float:
    """Return the upward part of a velocity in the body frame. [m/s]"""
    ux, uy, uz = up_in_body(attitude)
    return ux * surge + uy * sway + uz * heave


def as_measured(estimate: Estimate) -> Measured:
    """Return what the cascade acts on after the estimate went through its message."""
    attitude, airspeed = estimate.attitude, estimate.airspeed
    upward = heave(attitude, airspeed, estimate.altitude.climb)
    return Measured(
        estimate.altitude.height,
        climb(attitude, airspeed.surge, airspeed.sway, upward),
        heading(attitude),
        estimate.rates[2],
        airspeed.surge,
        airspeed.sway,
    )


def half_turn(angle: float) -> tuple[float, float]:
    """Return z and w of the quaternion of a level heading."""
    return math.sin(0.5 * angle), math.cos(0.5 * angle)


def as_setpoint(setpoint: Setpoint) -> Setpoint:
    """Return a setpoint after it went through its messages."""
    z, w = half_turn(setpoint.heading)
    return Setpoint(setpoint.altitude, heading((0.0, 0.0, z, w)), setpoint.speed)
