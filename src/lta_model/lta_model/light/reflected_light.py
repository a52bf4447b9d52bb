# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Indirect light on a vehicle's photodiodes: a sum over ray bundles, with shading by its own hull.

The bundles form rings, narrow about the horizon, where the far floor, far walls and the edge of
the hull's shade are, and wide elsewhere. A few rays sample each bundle. A ray that hits a surface
carries the lamp's illuminance there times the albedo (a Lambertian surface has the luminance
E / pi). Light reflected more than once is uniform over the room.

Plain functions of numbers and arrays, which compile. The compiler vectorises the loops over the
bundles of a ring, so powers and branches are separate. Not modelled: the hull's shadow on
surfaces, and daylight reflected by a room.
"""

from collections.abc import MutableSequence, Sequence
import itertools
import math

from lta_model.effects.protocol import Matrix3, Quaternion, Vector
from lta_model.light.direct_light import (
    angular_response,
    Array,
    DiodeResponse,
    direct_light,
    fraction_past_hull,
    LampBeam,
    unpack_beam,
    visible_fraction,
)
from lta_model.light.scene_geometry import (
    daylight_luminance,
    distance_to_wall,
    find_first_hit,
    find_room_hit,
    is_in_room,
    is_path_clear,
    is_sunlit,
    RayHit,
    SceneGeometry,
)
from lta_model.rigid_body import rotation_matrix, to_body, to_map

Rows = Array | tuple[tuple[float, ...], ...]
Scratch = MutableSequence[float] | Array
# Edges of the rings above and below the horizon [deg]; bundles in each; rays of one each way.
RING_EDGES = (0.0, 2.0, 4.5, 8.0, 13.0, 20.0, 30.0, 45.0, 65.0, 90.0)
RING_BUNDLES, BUNDLE_PARTS = 24, 2
# Smallest square of a distance, against a division by zero
LEAST_DISTANCE_SQUARE = 1e-300
# Offsets in a ring's scratch: cosines and sines of the bundles' azimuths, weight in a diode's
# reading, share that the hull leaves free, and incident light. Constants, so that the compiler
# sees which parts do not overlap.
COSINE_ROW, SINE_ROW, WEIGHT_ROW, UNHIDDEN_ROW, LIGHT_ROW = (
    RING_BUNDLES * row for row in range(5)
)
# Rows of incident and gathered light: uniform light, daylight, then the lamps.
UNIFORM_ROW, DAYLIGHT_ROW, LAMP_ROWS = range(3)
# Smallest base of a negative power
LEAST_BASE = 1e-300


def build_rings() -> tuple[tuple[float, ...], ...]:
    """Return the rings of ray bundles."""
    rings = []
    for low, high in itertools.pairwise(RING_EDGES):
        below, above = math.sin(math.radians(low)), math.sin(math.radians(high))
        # Solid angle over pi: diffuse light over the sphere sums to its illuminance
        size = 2.0 / RING_BUNDLES * (above - below)
        # The middle first, then a ray for each part of the height
        shares = (0.5, *((k + 0.5) / BUNDLE_PARTS for k in range(BUNDLE_PARTS)))
        # Above and below the horizon
        for side in (1.0, -1.0):
            ups = [side * (below + share * (above - below)) for share in shares]
            # Sine and cosine of the elevation of each
            ways = [number for up in ups for number in (up, math.sqrt(1.0 - up * up))]
            rings.append((size, 0.5 * math.radians(high - low), *ways))
    return tuple(rings)


def build_azimuth_rotations(parts: Sequence[float]) -> tuple[tuple[float, float], ...]:
    """Return cosine and sine of shares of a bundle's width around the vertical."""
    angles = [2.0 * math.pi * part / RING_BUNDLES for part in parts]
    return tuple((math.cos(angle), math.sin(angle)) for angle in angles)


RINGS = build_rings()
BUNDLE_AZIMUTHS = build_azimuth_rotations(
    [step + 0.5 for step in range(RING_BUNDLES)]
)  # the middle of each
RAY_OFFSETS = build_azimuth_rotations(
    [(ray + 0.5) / BUNDLE_PARTS - 0.5 for ray in range(BUNDLE_PARTS)]
)  # a ray from the middle


def scratch_size(lamps: int) -> int:
    """Return how much scratch a ring takes for a number of lamps."""
    return LIGHT_ROW + (LAMP_ROWS + lamps) * RING_BUNDLES


def write_azimuths(scratch: Scratch) -> None:
    """Write the azimuths of the bundles."""
    for step in range(RING_BUNDLES):
        scratch[COSINE_ROW + step], scratch[SINE_ROW + step] = BUNDLE_AZIMUTHS[step]


def reflected_luminance(s: SceneGeometry, met: RayHit, lamp: LampBeam) -> float:
    """Return the luminance of a surface by the direct light of a lamp, times pi [lx]."""
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
    squared = max(x * x + y * y + z * z, LEAST_DISTANCE_SQUARE)
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
    for step in range(RING_BUNDLES):
        scratch[LIGHT_ROW + RING_BUNDLES * UNIFORM_ROW + step] = 1.0
        scratch[LIGHT_ROW + RING_BUNDLES * DAYLIGHT_ROW + step] = day
    for k in range(len(lamps)):
        for step in range(RING_BUNDLES):
            scratch[LIGHT_ROW + RING_BUNDLES * (LAMP_ROWS + k) + step] = 0.0
    if s.top > 0.0:
        trace_through_door(s, lamps, point, ring, scratch)
    elif is_in_room(s, point[0], point[1], point[2]):
        for k in range(len(lamps)):
            for ray in range(BUNDLE_PARTS * BUNDLE_PARTS):
                # Ring layout: size, half height, middle (2), then sine and cosine of each ray
                up = 4 + 2 * (ray // BUNDLE_PARTS)
                side = RAY_OFFSETS[ray % BUNDLE_PARTS]
                trace_closed_room(
                    s, unpack_beam(lamps[k]), point, ring[up], ring[up + 1], side, scratch
                )
                for step in range(RING_BUNDLES):
                    scratch[LIGHT_ROW + RING_BUNDLES * (LAMP_ROWS + k) + step] += scratch[
                        WEIGHT_ROW + step
                    ]


def ray_direction(
    c: float, d: float, up: float, level: float, side: tuple[float, float]
) -> Vector:
    """Return the direction of a ray offset from the middle of its bundle [map]."""
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
    for step in range(RING_BUNDLES):
        u = ray_direction(scratch[COSINE_ROW + step], scratch[SINE_ROW + step], up, level, side)
        light, square = unoccluded_luminance(
            find_room_hit(s, point, u, distance_to_wall(s, point, u)), lamp
        )
        # WEIGHT and UNHIDDEN serve as scratch until the weights are computed
        scratch[WEIGHT_ROW + step], scratch[UNHIDDEN_ROW + step] = (
            light / (BUNDLE_PARTS * BUNDLE_PARTS),
            square,
        )
    if lamp.order != 1.0:
        for step in range(RING_BUNDLES):
            # Behind the lamp both are 0, and a lantern's exponent is below 0.
            square = max(scratch[UNHIDDEN_ROW + step], LEAST_BASE)
            # Order 1 is already in; the rest of cos^m
            scratch[WEIGHT_ROW + step] *= square ** (0.5 * lamp.order - 0.5)


def trace_through_door(
    s: SceneGeometry, lamps: Rows, point: Vector, ring: tuple[float, ...], scratch: Scratch
) -> None:
    """Add the light of each bundle in a room with a door, which rays pass both ways."""
    for step in range(RING_BUNDLES):
        for ray in range(BUNDLE_PARTS * BUNDLE_PARTS):
            up, side = 4 + 2 * (ray // BUNDLE_PARTS), RAY_OFFSETS[ray % BUNDLE_PARTS]
            u = ray_direction(
                scratch[COSINE_ROW + step], scratch[SINE_ROW + step], ring[up], ring[up + 1], side
            )
            met, inside = find_first_hit(s, point, u)
            scratch[LIGHT_ROW + RING_BUNDLES * DAYLIGHT_ROW + step] += daylight_luminance(
                s, inside, u[2]
            ) / (BUNDLE_PARTS * BUNDLE_PARTS)
            for k in range(len(lamps)):
                bright = reflected_luminance(s, met, unpack_beam(lamps[k])) / (
                    BUNDLE_PARTS * BUNDLE_PARTS
                )
                scratch[LIGHT_ROW + RING_BUNDLES * (LAMP_ROWS + k) + step] += bright


SUN_RADIUS = 4.7e-3  # rad, as seen from the earth


def compute_ring_weights(
    eye: DiodeResponse,
    hull: Vector,
    r: Matrix3,
    spot: Vector,
    axis: Vector,
    ring: tuple[float, ...],
    scratch: Scratch,
) -> bool:
    """Write the weight of each bundle of a ring in a diode's reading."""
    for step in range(RING_BUNDLES):
        c, d = scratch[COSINE_ROW + step], scratch[SINE_ROW + step]
        way = to_body(r, (ring[3] * c, ring[3] * d, ring[2]))
        # Share of the bundle that the hull leaves free
        scratch[UNHIDDEN_ROW + step] = (
            fraction_past_hull(hull, spot, way, ring[1]) if hull[0] > 0.0 else 1.0
        )
        scratch[WEIGHT_ROW + step] = axis[0] * way[0] + axis[1] * way[1] + axis[2] * way[2]
    # Separate loop: the power and the branches would stop the one above from vectorising
    used = False
    for step in range(RING_BUNDLES):
        cosine, free = scratch[WEIGHT_ROW + step], scratch[UNHIDDEN_ROW + step]
        scratch[WEIGHT_ROW + step] = 0.0
        if cosine > eye.least and cosine > 0.0 and free > 0.0:
            scratch[WEIGHT_ROW + step] = ring[0] * free * cosine**eye.exponent
            used = True
    return used


def dot_rows(scratch: Scratch, a: int, b: int) -> float:
    """Return the scalar product of two rows, with four partial sums for speed."""
    first, second, third, fourth = 0.0, 0.0, 0.0, 0.0
    for step in range(0, RING_BUNDLES, 4):
        first += scratch[a + step] * scratch[b + step]
        second += scratch[a + step + 1] * scratch[b + step + 1]
        third += scratch[a + step + 2] * scratch[b + step + 2]
        fourth += scratch[a + step + 3] * scratch[b + step + 3]
    return (first + second) + (third + fourth)


def diode_array_center(position: Vector, q: Quaternion, planes: Rows) -> Vector:
    """Return the middle of the diodes, from which rays are traced for all of them [m, map]."""
    x, y, z = 0.0, 0.0, 0.0
    for i in range(len(planes)):
        x += planes[i][0] / len(planes)
        y += planes[i][1] / len(planes)
        z += planes[i][2] / len(planes)
    x, y, z = to_map(rotation_matrix(q), (x, y, z))
    return position[0] + x, position[1] + y, position[2] + z


def gather_indirect_light(
    s: SceneGeometry,
    lamps: Rows,
    eye: DiodeResponse,
    hull: Vector,
    position: Vector,
    q: Quaternion,
    planes: Rows,
    out: Array,
    scratch: Scratch,
) -> None:
    """Write each diode's reading of all light except the lamps' direct light."""
    r, point = rotation_matrix(q), diode_array_center(position, q, planes)
    # The array is reused; sums start at zero
    for row in range(len(out)):
        for i in range(len(planes)):
            out[row, i] = 0.0
    write_azimuths(scratch)
    # Rays are traced once from the middle of the diodes, and weighted for each diode
    for ring in RINGS:
        trace_ring(s, lamps, point, ring, scratch)
        for i in range(len(planes)):
            spot = (planes[i][0], planes[i][1], planes[i][2])
            axis = (planes[i][3], planes[i][4], planes[i][5])
            if compute_ring_weights(eye, hull, r, spot, axis, ring, scratch):
                for row in range(len(out)):
                    out[row, i] += dot_rows(scratch, WEIGHT_ROW, LIGHT_ROW + RING_BUNDLES * row)
    if is_in_room(s, point[0], point[1], point[2]):
        for k in range(len(lamps)):
            for i in range(len(planes)):
                # Second and further reflections: uniform over the room
                out[LAMP_ROWS + k, i] += unpack_beam(lamps[k]).beyond * out[UNIFORM_ROW, i]
    if is_sunlit(s, point):
        way = to_body(r, (s.sun_x, s.sun_y, s.sun_z))
        for i in range(len(planes)):
            part = angular_response(eye, (planes[i][3], planes[i][4], planes[i][5]), way)
            if part > 0.0:
                spot = (planes[i][0], planes[i][1], planes[i][2])
                out[DAYLIGHT_ROW, i] += (
                    s.sun * part * visible_fraction(hull, spot, way, SUN_RADIUS)
                )
