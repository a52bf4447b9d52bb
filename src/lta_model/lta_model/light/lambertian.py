"""
Compute a lamp's direct light with plain functions of numbers.

The same light as `lta_model.light.lamp.direct_illuminance`, which takes whole arrays and says what
is behind it; this one serves what looks at few planes many times, and compiles.
"""

import math
from typing import NamedTuple

from lta_model.effects.protocol import Quaternion, Vector
from lta_model.light.lamp import BeaconLamp
from lta_model.light.room import Room
from lta_model.rigid_body import rotation_matrix, to_map
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Row = Array | tuple[float, ...]


class LampBeam(NamedTuple):
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
        What the room throws back, as if it were the same everywhere. [lx]
    beyond : float
        Of that what has been thrown back more than once. [lx]

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
    beyond: float


class DiodeResponse(NamedTuple):
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


def build_beam(lamp: BeaconLamp, room: Room | None = None, thrown: float = 0.0) -> LampBeam:
    """Return a lamp, of whose light the surfaces of a room throw back so much at once. [lm]"""
    diffuse = 0.0 if room is None else thrown / (room.surface_area * (1.0 - room.mean_albedo))
    beyond = 0.0 if room is None else diffuse * room.mean_albedo
    place, axis = lamp.position, lamp.direction
    return LampBeam(*place, *axis, lamp.intensity, lamp.order, lamp.radius**2, diffuse, beyond)


def direct_light(lamp: LampBeam, point: Vector) -> tuple[float, Vector]:
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
    cosine = leaving / distance
    if lamp.order != 1.0:  # skip the power function for order 1
        cosine = cosine**lamp.order
    return lamp.intensity * cosine / (squared + lamp.square), towards


def angular_response(eye: DiodeResponse, axis: Vector, towards: Vector) -> float:
    """Return which part of the light from a direction a diode with an axis reads. [1]"""
    cosine = axis[0] * towards[0] + axis[1] * towards[1] + axis[2] * towards[2]
    if cosine <= eye.least or cosine <= 0.0:
        return 0.0
    part: float = cosine**eye.exponent
    return part


def plane_illuminance(lamp: LampBeam, point: Vector, normal: Vector) -> float:
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
    light, towards = direct_light(lamp, point)
    return light * angular_response(DiodeResponse(1.0, 0.0), normal, towards) + lamp.diffuse


def direct_reading(lamp: LampBeam, eye: DiodeResponse, point: Vector, axis: Vector) -> float:
    """Return what a diode reads of the direct light of a lamp while it is on. [lx]"""
    light, towards = direct_light(lamp, point)
    return light * angular_response(eye, axis, towards)


def unpack_beam(row: Row) -> LampBeam:
    """Return a lamp from its numbers in a row."""
    return LampBeam(
        row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10]
    )  # fmt: skip


def place_in_map(
    position: Vector, q: Quaternion, point: Vector, axis: Vector
) -> tuple[Vector, Vector]:
    """Return a point [m] and an axis of the body in `map`."""
    r = rotation_matrix(q)
    x, y, z = to_map(r, point)
    return (position[0] + x, position[1] + y, position[2] + z), to_map(r, axis)
