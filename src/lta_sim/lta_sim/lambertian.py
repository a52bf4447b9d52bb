"""
The direct light of the lamp on one small plane, as plain functions of numbers.

The same light as `lta_sim.light_field.direct`, which takes whole arrays and says what is behind
it; this one serves what looks at few planes many times, and compiles.
"""

import math
from typing import NamedTuple

from lta_sim.effects.protocol import Quaternion, Vector
from lta_sim.light_field import LightField
from lta_sim.rigid_body import rotation
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Beam(NamedTuple):
    """
    A lamp while it is on, as numbers.

    Attributes
    ----------
    x, y, z : float
        Its place. [m, map]
    i, j, k : float
        Unit axis. [map]
    intensity : float
        On the axis. [cd]
    order : float
        Lambertian order.
    square : float
        Square of its radius. [m2]
    diffuse : float
        What the room throws back, the same everywhere. [lx]

    """

    x: float
    y: float
    z: float
    i: float
    j: float
    k: float
    intensity: float
    order: float
    square: float
    diffuse: float


def beam(field: LightField) -> Beam:
    """Return the lamp of a scene, with the room's echo of it."""
    lamp = field.lamp
    length = math.hypot(*lamp.axis)
    i, j, k = (part / length for part in lamp.axis)
    diffuse = 0.0 if field.room is None else field.room.diffuse(lamp.flux)
    return Beam(*lamp.position, i, j, k, lamp.intensity, lamp.order, lamp.radius**2, diffuse)


def lit(lamp: Beam, point: Vector, normal: Vector) -> float:
    """
    Return the light of the lamp on a small plane while it is on, the room's echo included.

    Parameters
    ----------
    lamp : Beam
        The lamp.
    point : tuple of float
        Where. [m, map]
    normal : tuple of float
        Unit normal of the plane. [map]

    Returns
    -------
    float
        Illuminance. [lx]

    """
    x, y, z = point[0] - lamp.x, point[1] - lamp.y, point[2] - lamp.z
    squared = x * x + y * y + z * z
    distance = math.sqrt(squared)
    leaving = x * lamp.i + y * lamp.j + z * lamp.k
    arriving = -(x * normal[0] + y * normal[1] + z * normal[2])
    if leaving <= 0.0 or arriving <= 0.0:
        return lamp.diffuse
    part: float = (leaving / distance) ** lamp.order * (arriving / distance)
    return lamp.intensity * part / (squared + lamp.square) + lamp.diffuse


def place(position: Vector, q: Quaternion, point: Vector, axis: Vector) -> tuple[Vector, Vector]:
    """Return a point [m] and an axis of the body in `map`."""
    r = rotation(q)
    a, b, c = point
    i, j, k = axis
    return (
        position[0] + (r[0] * a + r[1] * b + r[2] * c),
        position[1] + (r[3] * a + r[4] * b + r[5] * c),
        position[2] + (r[6] * a + r[7] * b + r[8] * c),
    ), (
        r[0] * i + r[1] * j + r[2] * k,
        r[3] * i + r[4] * j + r[5] * k,
        r[6] * i + r[7] * j + r[8] * k,
    )


def on_planes(lamp: Beam, poses: Array, planes: Array, out: Array) -> None:
    """
    Write the light on planes of a body at several poses.

    Parameters
    ----------
    lamp : Beam
        The lamp.
    poses : ndarray, shape (k, 7)
        Position [m] and quaternion x y z w, body -> map.
    planes : ndarray, shape (d, 6)
        Points [m] and unit normals, body frame.
    out : ndarray, shape (k, d)
        Illuminance while the lamp is on. [lx]

    """
    for k in range(poses.shape[0]):
        position = (poses[k, 0], poses[k, 1], poses[k, 2])
        q = (poses[k, 3], poses[k, 4], poses[k, 5], poses[k, 6])
        for i in range(planes.shape[0]):
            spot = (planes[i, 0], planes[i, 1], planes[i, 2])
            axis = (planes[i, 3], planes[i, 4], planes[i, 5])
            point, normal = place(position, q, spot, axis)
            out[k, i] = lit(lamp, point, normal)
