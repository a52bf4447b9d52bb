"""
What stands around a point: the surface that a ray meets, and whether a way is clear.

Plain functions of numbers, which compile. A scene is a box that stands on the floor, with or
without a door in its wall at the high end of x, and level ground beyond that door. A box without a
door has no outside: its surfaces are the end of the world.
"""

import math
from typing import NamedTuple

from lta_model.effects.protocol import Vector
from lta_model.light.daylight import Daylight
from lta_model.light.outside import Outside
from lta_model.light.room import Room

FAR = 1e9  # m; also the distance of the sun
NEAR = 1e-9  # m; a way may begin and end on a surface


class Surround(NamedTuple):
    """
    Room, door and daylight as numbers.

    Attributes
    ----------
    x, y, height : float
        Half length, half width and height of the room; nothing is reflected if the height is 0.
        [m]
    floor, walls, ceiling : float
        Albedos.
    middle, half_width, top : float
        Of the door, along y and up; no door if the top is 0. [m]
    sun_x, sun_y, sun_z : float
        Unit vector to the sun. [map]
    sun : float
        On a plane that faces it. [lx]
    sky, ground : float
        Luminance of the sky and of the ground under it, times pi. [lx]
    beyond : float
        Albedo of the ground beyond the door.

    """

    x: float
    y: float
    height: float
    floor: float
    walls: float
    ceiling: float
    middle: float
    half_width: float
    top: float
    sun_x: float
    sun_y: float
    sun_z: float
    sun: float
    sky: float
    ground: float
    beyond: float


class Hit(NamedTuple):
    """Where a ray meets a surface, its normal towards the ray, and its albedo; 0 is the sky."""

    x: float
    y: float
    z: float
    i: float
    j: float
    k: float
    albedo: float


def surround_of(room: Room | None, daylight: Daylight | None, outside: Outside | None) -> Surround:
    """Return a scene as numbers; daylight over all of it, or beyond a door."""
    size, albedo = ((0.0,) * 3, (0.0,) * 3) if room is None else (room.size, room.albedo)
    door = (0.0,) * 3
    if outside is not None:
        daylight = outside.daylight
        door = (outside.middle, 0.5 * outside.width, outside.height)
    sky = (0.0,) * 7
    if daylight is not None:
        ground = daylight.ground * daylight.level
        sky = (*daylight.towards, daylight.sun, daylight.sky, ground, daylight.ground)
    return Surround(0.5 * size[0], 0.5 * size[1], size[2], *albedo, *door, *sky)


def within(s: Surround, x: float, y: float, z: float) -> bool:
    """Tell whether a point is in the room."""
    return abs(x) <= s.x and abs(y) <= s.y and 0.0 <= z <= s.height


def in_door(s: Surround, x: float, y: float, z: float) -> bool:
    """Tell whether a point of the room's surface is in its door."""
    return s.top > 0.0 and x > s.x - NEAR and abs(y - s.middle) < s.half_width and z < s.top


def span(low: float, high: float, at: float, step: float) -> tuple[float, float]:
    """Return between which distances a ray is between two planes. [m]"""
    if step == 0.0:
        return (-FAR, FAR) if low <= at <= high else (FAR, -FAR)
    first, second = (low - at) / step, (high - at) / step
    return (first, second) if first < second else (second, first)


def crossing(s: Surround, point: Vector, u: Vector) -> tuple[float, float]:
    """Return at which distances a ray enters and leaves the room's box; never if first > last."""
    a, b = span(-s.x, s.x, point[0], u[0])
    c, d = span(-s.y, s.y, point[1], u[1])
    e, f = span(0.0, s.height, point[2], u[2])
    return max(a, c, e), min(b, d, f)


def ahead(s: Surround, point: Vector, u: Vector) -> float:
    """Return at which distance a ray from within leaves the room's box. [m]"""
    t = FAR
    if u[0] != 0.0:
        t = (math.copysign(s.x, u[0]) - point[0]) / u[0]
    if u[1] != 0.0:
        t = min(t, (math.copysign(s.y, u[1]) - point[1]) / u[1])
    if u[2] != 0.0:
        t = min(t, ((s.height if u[2] > 0.0 else 0.0) - point[2]) / u[2])
    return t


def clear(s: Surround, point: Vector, u: Vector, distance: float) -> bool:
    """
    Tell whether the way from a point along a ray is free of the walls.

    Parameters
    ----------
    s : Surround
        The scene.
    point, u : tuple of float
        Where it begins [m, map] and its unit vector.
    distance : float
        How long it is. [m]

    """
    if s.top == 0.0:
        return True
    enter, leave = crossing(s, point, u)
    if enter > leave or leave <= NEAR or enter >= distance - NEAR:
        return True
    x, y, z = point
    if enter > NEAR and not in_door(s, x + enter * u[0], y + enter * u[1], z + enter * u[2]):
        return False
    if leave < distance - NEAR:
        return in_door(s, x + leave * u[0], y + leave * u[1], z + leave * u[2])
    return True


def inner(s: Surround, point: Vector, u: Vector, t: float) -> Hit:
    """Return the room's surface from within, at the distance where a ray leaves it."""
    x, y, z = point[0] + t * u[0], point[1] + t * u[1], point[2] + t * u[2]
    across, along = abs(abs(x) - s.x), abs(abs(y) - s.y)
    flat = min(abs(z), abs(s.height - z))
    if flat <= across and flat <= along:
        if u[2] < 0.0:
            return Hit(x, y, 0.0, 0.0, 0.0, 1.0, s.floor)
        return Hit(x, y, s.height, 0.0, 0.0, -1.0, s.ceiling)
    if across <= along:
        return Hit(x, y, z, -math.copysign(1.0, u[0]), 0.0, 0.0, s.walls)
    return Hit(x, y, z, 0.0, -math.copysign(1.0, u[1]), 0.0, s.walls)


def ground(s: Surround, point: Vector, u: Vector) -> Hit:
    """Return the ground beyond the door, or the sky."""
    if u[2] >= 0.0 or s.top == 0.0:
        return Hit(0.0, 0.0, FAR, 0.0, 0.0, 1.0, 0.0)
    t = -point[2] / u[2]
    return Hit(point[0] + t * u[0], point[1] + t * u[1], 0.0, 0.0, 0.0, 1.0, s.beyond)


def hit(s: Surround, point: Vector, u: Vector) -> tuple[Hit, bool]:
    """
    Return what a ray meets first, and whether that is in the room.

    The outer faces of the building are black.
    """
    if s.height == 0.0:
        return ground(s, point, u), False
    x, y, z = point
    if within(s, x, y, z):
        leave = ahead(s, point, u)
        if in_door(s, x + leave * u[0], y + leave * u[1], z + leave * u[2]):
            return ground(s, point, u), False
        return inner(s, point, u, leave), True
    enter, leave = crossing(s, point, u)
    if s.top == 0.0 or enter > leave or leave <= NEAR:
        return ground(s, point, u), False
    if in_door(s, x + enter * u[0], y + enter * u[1], z + enter * u[2]):
        return inner(s, point, u, leave), True
    return Hit(x + enter * u[0], y + enter * u[1], z + enter * u[2], 0.0, 0.0, 1.0, 0.0), True


def daylit(s: Surround, indoors: bool, up: float) -> float:
    """Return the luminance of daylight along a ray that goes up or down, times pi. [lx]"""
    if s.top > 0.0 and indoors:
        return 0.0
    return s.sky if up > 0.0 else s.ground


def sunlit(s: Surround, point: Vector) -> bool:
    """Tell whether the sun shines on a point, hull apart."""
    if s.sun == 0.0:
        return False
    return clear(s, point, (s.sun_x, s.sun_y, s.sun_z), FAR)


def day_on(s: Surround, point: Vector, normal: Vector) -> float:
    """Return the light of sun, sky and ground on a plane, hull apart. [lx]"""
    inside = within(s, point[0], point[1], point[2])
    up = 0.5 * (1.0 + normal[2])  # of what the plane sees is sky
    day = up * daylit(s, inside, 1.0) + (1.0 - up) * daylit(s, inside, -1.0)
    if sunlit(s, point):
        cosine = normal[0] * s.sun_x + normal[1] * s.sun_y + normal[2] * s.sun_z
        day += s.sun * max(cosine, 0.0)
    return day
