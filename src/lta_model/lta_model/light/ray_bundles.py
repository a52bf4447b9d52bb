"""
Ray bundles that sample the light over the sphere, and the luminance of the surfaces hit.

The bundles form rings, narrow about the horizon, where the far floor, far walls and the edge of
the hull's shade are, and wide elsewhere. A few rays sample each bundle. A ray that hits a surface
carries the lamp's illuminance there times the albedo (a Lambertian surface has the luminance
E / pi).

The compiler vectorises the loops over the bundles of a ring, so powers and branches are separate.
"""

from collections.abc import MutableSequence, Sequence
import itertools
import math

from lta_model.effects.protocol import Vector
from lta_model.light.lambertian import Array, direct_light, LampBeam, unpack_beam
from lta_model.light.scene_geometry import (
    daylight_luminance,
    distance_to_wall,
    find_first_hit,
    find_room_hit,
    is_in_room,
    is_path_clear,
    RayHit,
    SceneGeometry,
)

Rows = Array | tuple[tuple[float, ...], ...]
Scratch = MutableSequence[float] | Array

# Edges of the rings above and below the horizon [deg]; bundles in each; rays of one each way.
EDGES = (0.0, 2.0, 4.5, 8.0, 13.0, 20.0, 30.0, 45.0, 65.0, 90.0)
ROUND, PARTS = 24, 2
# Smallest square of a distance, against a division by zero
LEAST = 1e-300
# Offsets in a ring's scratch: cosines and sines of the bundles' azimuths, weight in a diode's
# reading, share that the hull leaves free, and incident light. Constants, so that the compiler
# sees which parts do not overlap.
COSINE, SINE, WEIGHT, UNHIDDEN, BROUGHT = (ROUND * row for row in range(5))
# Rows of incident and gathered light: uniform light, daylight, then the lamps.
SHARE, DAY, LAMPS = range(3)
# Smallest base of a negative power
TINY = 1e-300


def build_rings() -> tuple[tuple[float, ...], ...]:
    """Return the rings of ray bundles."""
    rings = []
    for low, high in itertools.pairwise(EDGES):
        below, above = math.sin(math.radians(low)), math.sin(math.radians(high))
        # Solid angle over pi: diffuse light over the sphere sums to its illuminance
        size = 2.0 / ROUND * (above - below)
        # The middle first, then a ray for each part of the height
        shares = (0.5, *((k + 0.5) / PARTS for k in range(PARTS)))
        # Above and below the horizon
        for side in (1.0, -1.0):
            ups = [side * (below + share * (above - below)) for share in shares]
            # Sine and cosine of the elevation of each
            ways = [number for up in ups for number in (up, math.sqrt(1.0 - up * up))]
            rings.append((size, 0.5 * math.radians(high - low), *ways))
    return tuple(rings)


def build_azimuth_rotations(parts: Sequence[float]) -> tuple[tuple[float, float], ...]:
    """Return cosine and sine of shares of a bundle's width around the vertical."""
    angles = [2.0 * math.pi * part / ROUND for part in parts]
    return tuple((math.cos(angle), math.sin(angle)) for angle in angles)


RINGS = build_rings()
PENCILS = build_azimuth_rotations([step + 0.5 for step in range(ROUND)])  # the middle of each
BESIDE = build_azimuth_rotations(
    [(ray + 0.5) / PARTS - 0.5 for ray in range(PARTS)]
)  # a ray from the middle


def scratch_size(lamps: int) -> int:
    """Return how much scratch a ring takes for a number of lamps."""
    return BROUGHT + (LAMPS + lamps) * ROUND


def write_azimuths(scratch: Scratch) -> None:
    """Write the azimuths of the bundles."""
    for step in range(ROUND):
        scratch[COSINE + step], scratch[SINE + step] = PENCILS[step]


def reflected_luminance(s: SceneGeometry, met: RayHit, lamp: LampBeam) -> float:
    """Return the luminance of a surface by the direct light of a lamp, times pi. [lx]"""
    light, towards = direct_light(lamp, (met.x, met.y, met.z))
    cosine = towards[0] * met.i + towards[1] * met.j + towards[2] * met.k
    # Nothing reflects, or the surface faces away
    if met.albedo == 0.0 or light == 0.0 or cosine <= 0.0:
        return 0.0
    x, y, z = lamp.x - met.x, lamp.y - met.y, lamp.z - met.z
    # The wall around the door is between lamp and surface
    if not is_path_clear(s, (met.x, met.y, met.z), towards, math.sqrt(x * x + y * y + z * z)):
        return 0.0
    return met.albedo * light * cosine


def unoccluded_luminance(met: RayHit, lamp: LampBeam) -> tuple[float, float]:
    """
    Return `reflected_luminance` for a lamp of order 1 without obstacles; no branches.

    The luminance is times pi [lx]; the second value is the squared cosine at the lamp.
    """
    x, y, z = lamp.x - met.x, lamp.y - met.y, lamp.z - met.z
    squared = max(x * x + y * y + z * z, LEAST)
    leaving = max(-(x * lamp.i + y * lamp.j + z * lamp.k), 0.0)
    falling = max(x * met.i + y * met.j + z * met.k, 0.0)
    # The cosines at both ends are still times the distance: hence squared in the denominator
    light = lamp.intensity * leaving / (squared * (squared + lamp.square))
    return met.albedo * light * falling, leaving * leaving / squared


def trace_ring(
    s: SceneGeometry, lamps: Rows, point: Vector, ring: tuple[float, ...], scratch: Scratch
) -> None:
    """Write the light that each bundle of a ring carries to a point."""
    # With a door, daylight depends on the ray and is added below
    day = 0.0 if s.top > 0.0 else daylight_luminance(s, False, ring[2])
    for step in range(ROUND):
        scratch[BROUGHT + ROUND * SHARE + step] = 1.0
        scratch[BROUGHT + ROUND * DAY + step] = day
    for k in range(len(lamps)):
        for step in range(ROUND):
            scratch[BROUGHT + ROUND * (LAMPS + k) + step] = 0.0
    if s.top > 0.0:
        trace_through_door(s, lamps, point, ring, scratch)
    elif is_in_room(s, point[0], point[1], point[2]):
        for k in range(len(lamps)):
            for ray in range(PARTS * PARTS):
                # Ring layout: size, half height, middle (2), then sine and cosine of each ray
                up = 4 + 2 * (ray // PARTS)
                side = BESIDE[ray % PARTS]
                trace_closed_room(
                    s, unpack_beam(lamps[k]), point, ring[up], ring[up + 1], side, scratch
                )
                for step in range(ROUND):
                    scratch[BROUGHT + ROUND * (LAMPS + k) + step] += scratch[WEIGHT + step]


def ray_direction(
    c: float, d: float, up: float, level: float, side: tuple[float, float]
) -> Vector:
    """Return the direction of a ray offset from the middle of its bundle. [map]"""
    # Rotate the middle's azimuth by the offset of the ray
    return (level * (c * side[0] - d * side[1]), level * (c * side[1] + d * side[0]), up)


def trace_closed_room(
    s: SceneGeometry,
    lamp: LampBeam,
    point: Vector,
    up: float,
    level: float,
    side: tuple[float, float],
    scratch: Scratch,
) -> None:
    """Write one ray of each bundle for a lamp in a room without a door, at WEIGHT."""
    for step in range(ROUND):
        u = ray_direction(scratch[COSINE + step], scratch[SINE + step], up, level, side)
        light, square = unoccluded_luminance(
            find_room_hit(s, point, u, distance_to_wall(s, point, u)), lamp
        )
        # WEIGHT and UNHIDDEN serve as scratch until the weights are computed
        scratch[WEIGHT + step], scratch[UNHIDDEN + step] = light / (PARTS * PARTS), square
    if lamp.order != 1.0:
        for step in range(ROUND):
            # Behind the lamp both are 0, and a lantern's exponent is below 0.
            square = max(scratch[UNHIDDEN + step], TINY)
            # Order 1 is already in; the rest of cos^m
            scratch[WEIGHT + step] *= square ** (0.5 * lamp.order - 0.5)


def trace_through_door(
    s: SceneGeometry, lamps: Rows, point: Vector, ring: tuple[float, ...], scratch: Scratch
) -> None:
    """Add the light of each bundle in a room with a door, which rays pass both ways."""
    for step in range(ROUND):
        for ray in range(PARTS * PARTS):
            up, side = 4 + 2 * (ray // PARTS), BESIDE[ray % PARTS]
            u = ray_direction(
                scratch[COSINE + step], scratch[SINE + step], ring[up], ring[up + 1], side
            )
            met, inside = find_first_hit(s, point, u)
            scratch[BROUGHT + ROUND * DAY + step] += daylight_luminance(s, inside, u[2]) / (
                PARTS * PARTS
            )
            for k in range(len(lamps)):
                bright = reflected_luminance(s, met, unpack_beam(lamps[k])) / (PARTS * PARTS)
                scratch[BROUGHT + ROUND * (LAMPS + k) + step] += bright
