# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A lamp's direct light on few planes many times, and the shade of the vehicle's own hull.

The same light as `lta_model.light.lamp.direct_illuminance`, which takes whole arrays and documents
the model; these are plain functions of numbers, which compile.

In units of its half axes the hull is a ball, and a ray from p along u meets it if

    D(u) = (p . u)^2 - u^2 (p^2 - 1) > 0   and   p . u < 0.

D over the length of its gradient across u is the angle to the edge of the shade, to first order;
a source of half width w is hidden linearly as it moves from w outside to w inside.
"""

import math
from typing import NamedTuple

from lta_model.effects.protocol import Quaternion, Vector
from lta_model.light.field import Room
from lta_model.light.lamp import BeaconLamp
from lta_model.rigid_body import rotation_matrix, to_map
import numpy as np
from numpy.typing import NDArray

# Against the root of a rounding error below zero, and a division by zero
LEAST_SQUARE = 1e-300


def visible_fraction(
    half_axes: Vector, point: Vector, towards: Vector, half_width: float
) -> float:
    """
    Return the share of a small source that a point of the body sees past the hull, 0 to 1.

    Parameters
    ----------
    half_axes : tuple of float
        Of the hull, zeros where there is none. [m]
    point : tuple of float
        Point of view. [m, body]
    towards : tuple of float
        Unit vector to the middle of the source. [body]
    half_width : float
        Half its angular width, above 0. [rad]

    """
    return fraction_past_hull(half_axes, point, towards, half_width) if half_axes[0] > 0.0 else 1.0


def fraction_past_hull(
    half_axes: Vector, point: Vector, towards: Vector, half_width: float
) -> float:
    """Return `visible_fraction` for a vehicle with a hull, without branches."""
    a, b, c = half_axes
    # Scale the ellipsoid to a unit ball
    x, y, z = point[0] / a, point[1] / b, point[2] / c
    i, j, k = towards[0] / a, towards[1] / b, towards[2] / c
    along = x * i + y * j + z * k
    outside = x * x + y * y + z * z - 1.0
    # Discriminant D: positive where the ray hits the hull
    inside = along * along - (i * i + j * j + k * k) * outside
    # Gradient of D with respect to the direction
    p, q, r = (
        2.0 * (along * x - outside * i) / a,
        2.0 * (along * y - outside * j) / b,
        2.0 * (along * z - outside * k) / c,
    )
    ahead = p * towards[0] + q * towards[1] + r * towards[2]
    # Its component perpendicular to the ray
    across = math.sqrt(max(p * p + q * q + r * r - ahead * ahead, LEAST_SQUARE))
    part = min(max(0.5 - 0.5 * inside / (across * half_width), 0.0), 1.0)
    if outside <= 0.0:  # within the hull
        part = 0.0
    # The hull is behind the point
    return 1.0 if along >= 0.0 else part


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
    Return the light [lx] of a lamp on a facing plane at a point, and the unit vector to it [map].

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
    """Return the share of the light from a direction that a diode with an axis reads [1]."""
    cosine = axis[0] * towards[0] + axis[1] * towards[1] + axis[2] * towards[2]
    # Outside of the field of view, or behind the diode
    if cosine <= eye.least or cosine <= 0.0:
        return 0.0
    part: float = cosine**eye.exponent
    return part


def unpack_beam(row: Row) -> LampBeam:
    """Return a lamp from its numbers in a row."""
    return LampBeam(
        row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10]
    )


def transform_to_map(
    position: Vector, q: Quaternion, point: Vector, axis: Vector
) -> tuple[Vector, Vector]:
    """Return a point [m] and an axis of the body in `map`."""
    r = rotation_matrix(q)
    x, y, z = to_map(r, point)
    return (position[0] + x, position[1] + y, position[2] + z), to_map(r, axis)
