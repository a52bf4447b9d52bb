"""
Compute a lamp's direct light with plain functions of numbers.

The same light as `lta_model.light.lamp.direct_illuminance`, which takes whole arrays and documents
the model; this form is for few planes many times, and compiles.
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
    """A lamp while it is on, as numbers."""

    # Position [m, map]
    x: float
    y: float
    z: float
    # Unit axis [map]
    i: float
    j: float
    k: float
    intensity: float  # on the axis [cd]
    order: float  # Lambertian order
    square: float  # square of its radius [m2]
    # Reflected light, taken as uniform: in total, and reflected more than once [lx]
    diffuse: float
    beyond: float


class DiodeResponse(NamedTuple):
    """Angular response of a photodiode: exponent of the cosine, cosine at the edge of the view."""

    exponent: float
    least: float


def build_beam(lamp: BeaconLamp, room: Room | None = None, thrown: float = 0.0) -> LampBeam:
    """Return a lamp as numbers; `thrown` is its flux reflected once by a room [lm]."""
    # Integrating sphere: the sum over all further reflections
    diffuse = 0.0 if room is None else thrown / (room.surface_area * (1.0 - room.mean_albedo))
    # All but the first reflection
    beyond = 0.0 if room is None else diffuse * room.mean_albedo
    place, axis = lamp.position, lamp.direction
    return LampBeam(*place, *axis, lamp.intensity, lamp.order, lamp.radius**2, diffuse, beyond)


def direct_light(lamp: LampBeam, point: Vector) -> tuple[float, Vector]:
    """
    Return the light [lx] of a lamp on a facing plane at a point, and the unit vector to it. [map]

    The vector is zero at the lamp itself.
    """
    x, y, z = lamp.x - point[0], lamp.y - point[1], lamp.z - point[2]
    squared = x * x + y * y + z * z
    # Distance times the cosine at the lamp
    leaving = -(x * lamp.i + y * lamp.j + z * lamp.k)
    if squared == 0.0:
        return 0.0, (0.0, 0.0, 0.0)
    distance = math.sqrt(squared)
    towards = (x / distance, y / distance, z / distance)
    # Behind the lamp
    if leaving <= 0.0:
        return 0.0, towards
    cosine = leaving / distance
    if lamp.order != 1.0:  # skip the power function for order 1
        cosine = cosine**lamp.order
    # Inverse square with the radius of the disc, finite at the lamp
    return lamp.intensity * cosine / (squared + lamp.square), towards


def angular_response(eye: DiodeResponse, axis: Vector, towards: Vector) -> float:
    """Return the share of the light from a direction that a diode with an axis reads. [1]"""
    cosine = axis[0] * towards[0] + axis[1] * towards[1] + axis[2] * towards[2]
    # Outside of the field of view, or behind the diode
    if cosine <= eye.least or cosine <= 0.0:
        return 0.0
    part: float = cosine**eye.exponent
    return part


def plane_illuminance(lamp: LampBeam, point: Vector, normal: Vector) -> float:
    """Return the light [lx] of a lamp on a small plane while it is on, reflections included."""
    light, towards = direct_light(lamp, point)
    return light * angular_response(DiodeResponse(1.0, 0.0), normal, towards) + lamp.diffuse


def unpack_beam(row: Row) -> LampBeam:
    """Return a lamp from its numbers in a row."""
    return LampBeam(
        row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10]
    )  # fmt: skip


def transform_to_map(
    position: Vector, q: Quaternion, point: Vector, axis: Vector
) -> tuple[Vector, Vector]:
    """Return a point [m] and an axis of the body in `map`."""
    r = rotation_matrix(q)
    x, y, z = to_map(r, point)
    return (position[0] + x, position[1] + y, position[2] + z), to_map(r, axis)
