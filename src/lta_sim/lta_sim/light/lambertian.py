"""
The direct light of a lamp, as plain functions of numbers.

The same light as `lta_sim.light.lamp.direct`, which takes whole arrays and says what is behind
it; this one serves what looks at few planes many times, and compiles.
"""

import math
from typing import NamedTuple

from lta_sim.effects.protocol import Quaternion, Vector
from lta_sim.light.field import LightField
from lta_sim.light.lamp import Lamp
from lta_sim.light.room import Room
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


class Eye(NamedTuple):
    """
    How a photodiode's reading falls off with the angle between light and axis.

    Attributes
    ----------
    exponent : float
        Of the cosine.
    least : float
        Cosine at the edge of the field of view; nothing beyond it is seen.

    """

    exponent: float
    least: float


def beam(lamp: Lamp, room: Room | None) -> Beam:
    """Return a lamp with the room's echo of it."""
    diffuse = 0.0 if room is None else room.diffuse(lamp.flux)
    return Beam(
        *lamp.position, *lamp.direction, lamp.intensity, lamp.order, lamp.radius**2, diffuse
    )


def beams(field: LightField) -> Array:
    """Return the lamps of a scene, a row each in the order of `Beam`, shape (l, 10)."""
    return np.array([beam(lamp, field.room) for lamp in field.lamps])


def shine(lamp: Beam, point: Vector) -> tuple[float, Vector]:
    """
    Return the direct light of a lamp on a plane that faces it, and the direction to it.

    Parameters
    ----------
    lamp : Beam
        The lamp.
    point : tuple of float
        Where. [m, map]

    Returns
    -------
    light : float
        Illuminance while the lamp is on. [lx]
    towards : tuple of float
        Unit vector from the point to the lamp, zeros at the lamp itself. [map]

    """
    x, y, z = lamp.x - point[0], lamp.y - point[1], lamp.z - point[2]
    squared = x * x + y * y + z * z
    leaving = -(x * lamp.i + y * lamp.j + z * lamp.k)
    if squared == 0.0:
        return 0.0, (0.0, 0.0, 0.0)
    distance = math.sqrt(squared)
    towards = (x / distance, y / distance, z / distance)
    if leaving <= 0.0:
        return 0.0, towards
    return lamp.intensity * (leaving / distance) ** lamp.order / (squared + lamp.square), towards


def seen(eye: Eye, axis: Vector, towards: Vector) -> float:
    """Return which part of the light from a direction a diode with an axis reads. [1]"""
    cosine = axis[0] * towards[0] + axis[1] * towards[1] + axis[2] * towards[2]
    if cosine <= eye.least or cosine <= 0.0:
        return 0.0
    part: float = cosine**eye.exponent
    return part


def seen_all_round(eye: Eye) -> float:
    """
    Return what a diode reads of light that comes alike from all sides, a cosine's reading being 1.

    The radiance E / pi over the field of view: 2 / (n + 1) (1 - c^(n + 1)).
    """
    power = eye.exponent + 1.0
    part: float = 2.0 * (1.0 - max(eye.least, 0.0) ** power) / power
    return part


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
    light, towards = shine(lamp, point)
    return light * seen(Eye(1.0, 0.0), normal, towards) + lamp.diffuse


def read(lamp: Beam, eye: Eye, point: Vector, axis: Vector) -> float:
    """Return the light of the lamp that a diode reads while it is on; as `lit`. [lx]"""
    light, towards = shine(lamp, point)
    return light * seen(eye, axis, towards) + lamp.diffuse * seen_all_round(eye)


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


def beam_of(row: Array) -> Beam:
    """Return a lamp from a row of `beams`."""
    return Beam(
        row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9]
    )  # fmt: skip


def on_diodes(lamps: Array, eye: Eye, poses: Array, planes: Array, out: Array) -> None:
    """
    Write what the diodes of a body read of the lamps at several poses.

    Parameters
    ----------
    lamps : ndarray, shape (l, 10)
        From `beams`.
    eye : Eye
        Of the diodes.
    poses : ndarray, shape (k, 7)
        Position [m] and quaternion x y z w, body -> map.
    planes : ndarray, shape (d, 6)
        Points [m] and unit axes, body frame.
    out : ndarray, shape (l, k, d)
        Illuminance while each lamp is on. [lx]

    """
    for k in range(poses.shape[0]):
        position = (poses[k, 0], poses[k, 1], poses[k, 2])
        q = (poses[k, 3], poses[k, 4], poses[k, 5], poses[k, 6])
        for i in range(planes.shape[0]):
            spot = (planes[i, 0], planes[i, 1], planes[i, 2])
            point, axis = place(position, q, spot, (planes[i, 3], planes[i, 4], planes[i, 5]))
            for lamp in range(lamps.shape[0]):
                out[lamp, k, i] = read(beam_of(lamps[lamp]), eye, point, axis)
