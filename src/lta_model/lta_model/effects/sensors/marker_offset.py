"""
Frame of the tracked markers on the vehicle, against the body frame.

A tracker reports the pose of a rigid body whose axes and origin were drawn on its screen. Its
origin is at (x, y, z) in the body, and R = Rz(yaw) Ry(pitch) Rx(roll) turns marker axes to body
axes:

    p_read = p + R_body (x, y, z),   q_read = q q_R

It moves with the vehicle, unlike `tracker_misalignment`, which turns the room.
"""

import math

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values
from lta_model.effects.sensors.tracker_misalignment import euler_to_quaternion

_ARM = 'assumed: the origin is set by eye to the middle of the hull; limit: the size of a room'
_TURN = 'assumed: the axes are drawn by eye while the vehicle is held level; limit: any rotation'

PARAMETERS = (
    *(EffectParameter(axis, 'm', 0.0, -10.0, 10.0, 0.03, _ARM) for axis in 'xyz'),
    *(
        EffectParameter(angle, 'rad', 0.0, -math.pi, math.pi, 0.05, _TURN)
        for angle in ('yaw', 'pitch', 'roll')
    ),
)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return position and quaternion x y z w of the marker frame. [m, 1]"""
    x, y, z, yaw, pitch, roll = p
    a, b, c, d = euler_to_quaternion(yaw, pitch, roll)
    east, north, up, i, j, k, l = values  # noqa: E741
    # arm + 2 l (q x arm) + 2 q x (q x arm), q = (i, j, k) the vector part of the attitude.
    f, g, h = 2.0 * (j * z - k * y), 2.0 * (k * x - i * z), 2.0 * (i * y - j * x)
    return (
        east + x + l * f + j * h - k * g,
        north + y + l * g + k * f - i * h,
        up + z + l * h + i * g - j * f,
        l * a + d * i + j * c - k * b,
        l * b + d * j + k * a - i * c,
        l * c + d * k + i * b - j * a,
        l * d - i * a - j * b - k * c,
    )


EFFECT = MeasurementEffect('marker_offset', PARAMETERS, 'pose', compute_reading)
