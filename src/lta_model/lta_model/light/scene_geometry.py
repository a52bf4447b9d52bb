# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Scene geometry for ray tracing: the surface that a ray hits, and whether a path is clear.

Plain functions of numbers, which compile. A scene is a box on the floor, with or without a door in
its wall at the high end of x, and level ground beyond that door. A box without a door has no
outside.
"""

import math
from typing import NamedTuple

from lta_model.effects.protocol import Vector
from lta_model.light.field import Daylight, OutdoorArea, Room

FAR_DISTANCE = 1e9  # m; also the distance of the sun
SURFACE_TOLERANCE = 1e-9  # m; tolerance, because a path may begin and end on a surface


class SceneGeometry(NamedTuple):
    """Room, door and daylight as numbers."""

    # Half length, half width and height of the room; no room if the height is 0 [m]
    x: float
    y: float
    height: float
    # Albedos
    floor: float
    walls: float
    ceiling: float
    # Of the door, along y and up; no door if the top is 0 [m]
    middle: float
    half_width: float
    top: float
    # Unit vector to the sun [map]
    sun_x: float
    sun_y: float
    sun_z: float
    sun: float  # illuminance by the sun on a facing plane [lx]
    # Luminance of sky and ground, times pi [lx]
    sky: float
    ground: float
    beyond: float  # albedo of the ground beyond the door


class RayHit(NamedTuple):
    """Point where a ray hits a surface, normal towards the ray, and albedo; 0 is the sky."""

    x: float
    y: float
    z: float
    i: float
    j: float
    k: float
    albedo: float


def build_scene_geometry(
    room: Room | None, daylight: Daylight | None, outside: OutdoorArea | None
) -> SceneGeometry:
    """Return a scene as numbers; daylight over all of it, or beyond a door."""
    size, albedo = ((0.0,) * 3, (0.0,) * 3) if room is None else (room.size, room.albedo)
    door = (0.0,) * 3
    if outside is not None:
        daylight = outside.daylight
        door = (outside.middle, 0.5 * outside.width, outside.height)
    sky = (0.0,) * 7
    if daylight is not None:
        ground = daylight.ground * daylight.ground_illuminance
        sky = (*daylight.sun_direction, daylight.sun, daylight.sky, ground, daylight.ground)
    return SceneGeometry(0.5 * size[0], 0.5 * size[1], size[2], *albedo, *door, *sky)


def is_in_room(s: SceneGeometry, x: float, y: float, z: float) -> bool:
    """Return whether a point is in the room."""
    return abs(x) <= s.x and abs(y) <= s.y and 0.0 <= z <= s.height


def is_in_door(s: SceneGeometry, x: float, y: float, z: float) -> bool:
    """Return whether a point of the room's surface is in its door."""
    return (
        s.top > 0.0
        and x > s.x - SURFACE_TOLERANCE
        and abs(y - s.middle) < s.half_width
        and z < s.top
    )


def slab_crossing(low: float, high: float, at: float, step: float) -> tuple[float, float]:
    """Return between which distances a ray is between two planes [m]."""
    # Parallel to the planes: always between them, or never
    if step == 0.0:
        return (
            (-FAR_DISTANCE, FAR_DISTANCE) if low <= at <= high else (FAR_DISTANCE, -FAR_DISTANCE)
        )
    first, second = (low - at) / step, (high - at) / step
    return (first, second) if first < second else (second, first)


def box_crossing(s: SceneGeometry, point: Vector, u: Vector) -> tuple[float, float]:
    """Return at which distances a ray enters and leaves the room's box; never if first > last."""
    a, b = slab_crossing(-s.x, s.x, point[0], u[0])
    c, d = slab_crossing(-s.y, s.y, point[1], u[1])
    e, f = slab_crossing(0.0, s.height, point[2], u[2])
    # Slab method: inside the box while inside of all three pairs of planes
    return max(a, c, e), min(b, d, f)


def distance_to_wall(s: SceneGeometry, point: Vector, u: Vector) -> float:
    """Return at which distance a ray from within leaves the room's box [m]."""
    t = FAR_DISTANCE
    if u[0] != 0.0:
        # From within, only the plane ahead matters
        t = (math.copysign(s.x, u[0]) - point[0]) / u[0]
    if u[1] != 0.0:
        t = min(t, (math.copysign(s.y, u[1]) - point[1]) / u[1])
    if u[2] != 0.0:
        t = min(t, ((s.height if u[2] > 0.0 else 0.0) - point[2]) / u[2])
    return t


def is_path_clear(s: SceneGeometry, point: Vector, u: Vector, distance: float) -> bool:
    """Return whether a path from a point [m, map] along a unit vector is free of walls."""
    # Without a door there is nothing outside, and a box is convex
    if s.top == 0.0:
        return True
    enter, leave = box_crossing(s, point, u)
    # The path misses the box, or ends before it
    if enter > leave or leave <= SURFACE_TOLERANCE or enter >= distance - SURFACE_TOLERANCE:
        return True
    x, y, z = point
    # From outside it must enter through the door
    if enter > SURFACE_TOLERANCE and not is_in_door(
        s, x + enter * u[0], y + enter * u[1], z + enter * u[2]
    ):
        return False
    # From inside it must leave through the door
    if leave < distance - SURFACE_TOLERANCE:
        return is_in_door(s, x + leave * u[0], y + leave * u[1], z + leave * u[2])
    return True


def find_room_hit(s: SceneGeometry, point: Vector, u: Vector, t: float) -> RayHit:
    """Return the room's surface at the distance t where a ray from within leaves it."""
    x, y, z = point[0] + t * u[0], point[1] + t * u[1], point[2] + t * u[2]
    # The face that is nearest to the point is the one hit, whatever the rounding
    across, along = abs(abs(x) - s.x), abs(abs(y) - s.y)
    flat = min(abs(z), abs(s.height - z))
    if flat <= across and flat <= along:
        if u[2] < 0.0:
            return RayHit(x, y, 0.0, 0.0, 0.0, 1.0, s.floor)
        return RayHit(x, y, s.height, 0.0, 0.0, -1.0, s.ceiling)
    if across <= along:
        return RayHit(x, y, z, -math.copysign(1.0, u[0]), 0.0, 0.0, s.walls)
    return RayHit(x, y, z, 0.0, -math.copysign(1.0, u[1]), 0.0, s.walls)


def find_outdoor_hit(s: SceneGeometry, point: Vector, u: Vector) -> RayHit:
    """Return the ground beyond the door, or the sky."""
    # Albedo 0 stands for the sky
    if u[2] >= 0.0 or s.top == 0.0:
        return RayHit(0.0, 0.0, FAR_DISTANCE, 0.0, 0.0, 1.0, 0.0)
    # Level ground at z = 0
    t = -point[2] / u[2]
    return RayHit(point[0] + t * u[0], point[1] + t * u[1], 0.0, 0.0, 0.0, 1.0, s.beyond)


def find_first_hit(s: SceneGeometry, point: Vector, u: Vector) -> tuple[RayHit, bool]:
    """
    Return the first surface that a ray hits, and whether it is in the room.

    The outer faces of the building are black.
    """
    if s.height == 0.0:
        return find_outdoor_hit(s, point, u), False
    x, y, z = point
    if is_in_room(s, x, y, z):
        leave = distance_to_wall(s, point, u)
        if is_in_door(s, x + leave * u[0], y + leave * u[1], z + leave * u[2]):
            return find_outdoor_hit(s, point, u), False
        return find_room_hit(s, point, u, leave), True
    enter, leave = box_crossing(s, point, u)
    if s.top == 0.0 or enter > leave or leave <= SURFACE_TOLERANCE:
        return find_outdoor_hit(s, point, u), False
    if is_in_door(s, x + enter * u[0], y + enter * u[1], z + enter * u[2]):
        return find_room_hit(s, point, u, leave), True
    return RayHit(x + enter * u[0], y + enter * u[1], z + enter * u[2], 0.0, 0.0, 1.0, 0.0), True


def daylight_luminance(s: SceneGeometry, indoors: bool, up: float) -> float:
    """Return the luminance of daylight along an upward or downward ray, times pi [lx]."""
    # Daylight reflected in the room is not modelled
    if s.top > 0.0 and indoors:
        return 0.0
    return s.sky if up > 0.0 else s.ground


def is_sunlit(s: SceneGeometry, point: Vector) -> bool:
    """Return whether the sun shines on a point, without the hull's shade."""
    if s.sun == 0.0:
        return False
    return is_path_clear(s, point, (s.sun_x, s.sun_y, s.sun_z), FAR_DISTANCE)


def daylight_illuminance(s: SceneGeometry, point: Vector, normal: Vector) -> float:
    """Return the light of sun, sky and ground on a plane, without the hull's shade [lx]."""
    inside = is_in_room(s, point[0], point[1], point[2])
    up = 0.5 * (1.0 + normal[2])  # share of the sky in the plane's field of view
    day = up * daylight_luminance(s, inside, 1.0) + (1.0 - up) * daylight_luminance(
        s, inside, -1.0
    )
    if is_sunlit(s, point):
        cosine = normal[0] * s.sun_x + normal[1] * s.sun_y + normal[2] * s.sun_z
        day += s.sun * max(cosine, 0.0)
    return day
