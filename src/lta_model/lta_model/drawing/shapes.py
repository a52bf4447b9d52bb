# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Simple shapes to draw a scene: bodies with a position, a size and a colour.

Lengths in metres, quaternions x y z w, colours red green blue and opacity from 0 to 1. A
cylinder stands along its z.
"""

from collections.abc import Sequence
import math
from typing import NamedTuple

Three = tuple[float, float, float]
Turn = tuple[float, float, float, float]
Colour = tuple[float, float, float, float]

X: Three = (1.0, 0.0, 0.0)
Z: Three = (0.0, 0.0, 1.0)
NO_SHIFT: Three = (0.0, 0.0, 0.0)
NO_TURN: Turn = (0.0, 0.0, 0.0, 1.0)


class EllipsoidShape(NamedTuple):
    """An ellipsoid along its own axes."""

    place: Three
    size: Three
    colour: Colour
    turn: Turn = NO_TURN


class BoxShape(NamedTuple):
    """A box along its own axes."""

    place: Three
    size: Three
    colour: Colour
    turn: Turn = NO_TURN


class CylinderShape(NamedTuple):
    """A cylinder or cone about its own z; `bottom` and `top` scale the radius of its ends."""

    place: Three
    size: Three
    colour: Colour
    turn: Turn = NO_TURN
    bottom: float = 1.0
    top: float = 1.0


class PolylineShape(NamedTuple):
    """A line through points; with `pairs`, separate strokes between pairs of points."""

    points: tuple[Three, ...]
    thickness: float
    colour: Colour
    pairs: bool = False


class BillboardText(NamedTuple):
    """A text that always faces the viewer."""

    place: Three
    text: str
    height: float
    colour: Colour


Shape = EllipsoidShape | BoxShape | CylinderShape | PolylineShape | BillboardText


class ShapeEntity(NamedTuple):
    """Shapes that are drawn and replaced together, by name; without shapes it is removed."""

    name: str
    frame: str
    shapes: tuple[Shape, ...]


def rotation_between(start: Three, direction: Three) -> Turn:
    """
    Return the shortest rotation from a unit vector to a direction.

    `direction` may have any length but zero.
    """
    length = math.hypot(*direction)
    x, y, z = (number / length for number in direction)
    p, q, r = start
    # Half-angle quaternion: cross product, and 1 plus dot product, before normalisation
    turn = (q * z - r * y, r * x - p * z, p * y - q * x, 1.0 + p * x + q * y + r * z)
    norm = math.hypot(*turn)
    if norm < 1e-9:  # opposite: half a turn about any perpendicular axis
        return (0.0, 0.0, 1.0, 0.0) if r == 0.0 else (1.0, 0.0, 0.0, 0.0)
    a, b, c, d = turn
    return a / norm, b / norm, c / norm, d / norm


def move_point(place: Three, direction: Three, length: float) -> Three:
    """Return the point at a distance along a unit direction [m]."""
    x, y, z = (p + length * d for p, d in zip(place, direction, strict=True))
    return x, y, z


def to_triple(numbers: Sequence[float]) -> Three:
    """Return three numbers as a tuple, typed as such."""
    x, y, z = numbers
    return float(x), float(y), float(z)
