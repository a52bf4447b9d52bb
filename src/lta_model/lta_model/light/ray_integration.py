"""
Compute the indirect light on a vehicle's photodiodes, with shading by its own hull.

The light is integrated over the sphere as a sum over ray bundles (`lta_model.light.ray_bundles`);
light reflected more than once is uniform over the room. Plain functions of numbers and arrays,
which compile. Not modelled: the hull's shadow on surfaces, and daylight reflected by a room.
"""

from lta_model.effects.protocol import Matrix3, Quaternion, Vector
from lta_model.light.lambertian import angular_response, Array, DiodeResponse, unpack_beam
from lta_model.light.ray_bundles import (
    BROUGHT,
    COSINE,
    DAY,
    LAMPS,
    RINGS,
    ROUND,
    Rows,
    Scratch,
    SHARE,
    SINE,
    trace_ring,
    UNHIDDEN,
    WEIGHT,
    write_azimuths,
)
from lta_model.light.scene_geometry import is_in_room, is_sunlit, SceneGeometry
from lta_model.light.shade import fraction_past_hull, visible_fraction
from lta_model.rigid_body import rotation_matrix, to_body, to_map

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
    for step in range(ROUND):
        c, d = scratch[COSINE + step], scratch[SINE + step]
        way = to_body(r, (ring[3] * c, ring[3] * d, ring[2]))
        # Share of the bundle that the hull leaves free
        scratch[UNHIDDEN + step] = (
            fraction_past_hull(hull, spot, way, ring[1]) if hull[0] > 0.0 else 1.0
        )
        scratch[WEIGHT + step] = axis[0] * way[0] + axis[1] * way[1] + axis[2] * way[2]
    # Separate loop: the power and the branches would stop the one above from vectorising
    used = False
    for step in range(ROUND):
        cosine, free = scratch[WEIGHT + step], scratch[UNHIDDEN + step]
        scratch[WEIGHT + step] = 0.0
        if cosine > eye.least and cosine > 0.0 and free > 0.0:
            scratch[WEIGHT + step] = ring[0] * free * cosine**eye.exponent
            used = True
    return used


def dot_rows(scratch: Scratch, a: int, b: int) -> float:
    """Return the scalar product of two rows, with four partial sums for speed."""
    first, second, third, fourth = 0.0, 0.0, 0.0, 0.0
    for step in range(0, ROUND, 4):
        first += scratch[a + step] * scratch[b + step]
        second += scratch[a + step + 1] * scratch[b + step + 1]
        third += scratch[a + step + 2] * scratch[b + step + 2]
        fourth += scratch[a + step + 3] * scratch[b + step + 3]
    return (first + second) + (third + fourth)


def diode_array_center(position: Vector, q: Quaternion, planes: Rows) -> Vector:
    """Return the middle of the diodes, from which rays are traced for all of them. [m, map]"""
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
                    out[row, i] += dot_rows(scratch, WEIGHT, BROUGHT + ROUND * row)
    if is_in_room(s, point[0], point[1], point[2]):
        for k in range(len(lamps)):
            for i in range(len(planes)):
                # Second and further reflections: uniform over the room
                out[LAMPS + k, i] += unpack_beam(lamps[k]).beyond * out[SHARE, i]
    if is_sunlit(s, point):
        way = to_body(r, (s.sun_x, s.sun_y, s.sun_z))
        for i in range(len(planes)):
            part = angular_response(eye, (planes[i][3], planes[i][4], planes[i][5]), way)
            if part > 0.0:
                spot = (planes[i][0], planes[i][1], planes[i][2])
                out[DAY, i] += s.sun * part * visible_fraction(hull, spot, way, SUN_RADIUS)
