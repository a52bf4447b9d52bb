"""
Rotation of the tracker's frame against the map about their common origin.

Its axes are those of the map, turned by `yaw` about z, then by `pitch` about the new y and by
`roll` about the new x: R = Rz(yaw) Ry(pitch) Rx(roll), tracker -> map. A point and an attitude
read

    p_read = R' p,   q_read = q_R* q

so a level flight appears to climb by pitch times the distance. Body-frame velocities and rates are
unaffected. Gravity stays vertical in the map, so a tilt shows as a difference between the
attitudes of tracker and accelerometer.
"""

import math

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Quaternion, Values

_YAW = 'assumed: the x axis of the tracker is aligned by eye with a line on the floor'
_TILT = 'assumed: calibration square on a floor that is level to half a degree'

PARAMETERS = (
    EffectParameter('yaw', 'rad', 0.0, -math.pi, math.pi, 0.09, _YAW),
    EffectParameter('pitch', 'rad', 0.0, -0.5, 0.5, 0.009, _TILT),
    EffectParameter('roll', 'rad', 0.0, -0.5, 0.5, 0.009, _TILT),
)


def euler_to_quaternion(yaw: float, pitch: float, roll: float) -> Quaternion:
    """Return the quaternion x y z w of Rz(yaw) Ry(pitch) Rx(roll)."""
    # Half angles, as always in quaternions
    a, b, c = math.cos(0.5 * yaw), math.cos(0.5 * pitch), math.cos(0.5 * roll)
    d, e, f = math.sin(0.5 * yaw), math.sin(0.5 * pitch), math.sin(0.5 * roll)
    return (
        a * b * f - d * e * c,
        a * e * c + d * b * f,
        d * b * c - a * e * f,
        a * b * c + d * e * f,
    )


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return position and quaternion x y z w in the tracker's frame. [m, 1]"""
    yaw, pitch, roll = p
    a, b, c, d = euler_to_quaternion(yaw, pitch, roll)
    x, y, z, i, j, k, w = values
    # p - 2 d (v x p) + 2 v x (v x p): the turn back, v = (a, b, c) the vector part.
    s, t, u = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
    return (
        x - d * s + b * u - c * t,
        y - d * t + c * s - a * u,
        z - d * u + a * t - b * s,
        # q_R* q: the conjugate turns the attitude into the tracker's frame
        d * i - a * w - b * k + c * j,
        d * j - b * w - c * i + a * k,
        d * k - c * w - a * j + b * i,
        d * w + a * i + b * j + c * k,
    )


EFFECT = MeasurementEffect('tracker_misalignment', PARAMETERS, 'pose', compute_reading)
