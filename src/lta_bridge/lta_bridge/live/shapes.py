"""
What a scene is drawn from: simple bodies with a place, a size and a colour.

Lengths in metres, quaternions x y z w, colours red green blue and opacity from 0 to 1. A body has
the axes that Foxglove gives it: an arrow points along its x, a cylinder stands along its z.
"""

import math
from typing import NamedTuple

Three = tuple[float, float, float]
Turn = tuple[float, float, float, float]
Colour = tuple[float, float, float, float]

X: Three = (1.0, 0.0, 0.0)
Z: Three = (0.0, 0.0, 1.0)
ORIGIN: Three = (0.0, 0.0, 0.0)
LEVEL: Turn = (0.0, 0.0, 0.0, 1.0)


class EllipsoidShape(NamedTuple):
    """An ellipsoid along its own axes."""

    place: Three
    size: Three
    colour: Colour
    turn: Turn = LEVEL


class BoxShape(NamedTuple):
    """A box along its own axes."""

    place: Three
    size: Three
    colour: Colour
    turn: Turn = LEVEL


class CylinderShape(NamedTuple):
    """A cylinder or cone about its own z; `bottom` and `top` are the ends' shares of its size."""

    place: Three
    size: Three
    colour: Colour
    turn: Turn = LEVEL
    bottom: float = 1.0
    top: float = 1.0


class ArrowShape(NamedTuple):
    """An arrow from its place along its own x."""

    place: Three
    length: float
    thickness: float
    colour: Colour
    turn: Turn = LEVEL


class LineShape(NamedTuple):
    """A line through points; with `pairs` a stroke from each second point to the next."""

    points: tuple[Three, ...]
    thickness: float
    colour: Colour
    pairs: bool = False


class LabelShape(NamedTuple):
    """A word that faces whoever looks."""

    place: Three
    text: str
    height: float
    colour: Colour


Shape = EllipsoidShape | BoxShape | CylinderShape | ArrowShape | LineShape | LabelShape


class ShapeEntity(NamedTuple):
    """What is drawn, moved and replaced together, by its name; without shapes it vanishes."""

    name: str
    frame: str
    shapes: tuple[Shape, ...]


def rotation_between(start: Three, direction: Three) -> Turn:
    """
    Return the shortest turn of one direction onto another.

    Parameters
    ----------
    start : 3-tuple
        Unit vector that is turned.
    direction : 3-tuple
        Where to, of any length but zero.

    """
    length = math.hypot(*direction)
    x, y, z = (number / length for number in direction)
    p, q, r = start
    turn = (q * z - r * y, r * x - p * z, p * y - q * x, 1.0 + p * x + q * y + r * z)
    norm = math.hypot(*turn)
    if norm < 1e-9:  # right back: half a turn about whatever is across
        return (0.0, 0.0, 1.0, 0.0) if r == 0.0 else (1.0, 0.0, 0.0, 0.0)
    a, b, c, d = turn
    return a / norm, b / norm, c / norm, d / norm


def move_point(place: Three, direction: Three, length: float) -> Three:
    """Return the place that lies a length away along a unit direction. [m]"""
    x, y, z = (p + length * d for p, d in zip(place, direction, strict=True))
    return x, y, z


def to_triple(numbers: tuple[float, ...]) -> Three:
    """Return three numbers as such."""
    x, y, z = numbers
    return float(x), float(y), float(z)
