"""
What the photodiodes of a vehicle read of everything around it but lamps, in its own hull's shade.

This light is gathered over the sphere, as the sum of what pencils of rays bring
(`lta_model.light.pencils`); what has been thrown back more than once comes from all of the room
alike.

Plain functions of numbers and arrays, which compile. Left out: the shade that the hull throws on
surfaces, and daylight that a room throws on.
"""

from lta_model.effects.protocol import Matrix3, Quaternion, Vector
from lta_model.light.lambertian import Array, beam_of, Eye, seen
from lta_model.light.pencils import (
    BROUGHT,
    brought,
    COSINE,
    DAY,
    LAMPS,
    RINGS,
    ROUND,
    Rows,
    Scratch,
    SHARE,
    SINE,
    turned,
    UNHIDDEN,
    WEIGHT,
)
from lta_model.light.shade import past, visible
from lta_model.light.surround import sunlit, Surround, within
from lta_model.rigid_body import rotation, to_body, to_map

SUN_RADIUS = 4.7e-3  # rad, as seen from the earth


def let_in(
    eye: Eye,
    hull: Vector,
    r: Matrix3,
    spot: Vector,
    axis: Vector,
    ring: tuple[float, ...],
    scratch: Scratch,
) -> bool:
    """
    Write what a diode reads of each pencil of a ring, as part of its luminance times pi.

    Returns
    -------
    bool
        Whether it reads anything of the ring.

    """
    for step in range(ROUND):
        c, d = scratch[COSINE + step], scratch[SINE + step]
        way = to_body(r, (ring[3] * c, ring[3] * d, ring[2]))
        scratch[UNHIDDEN + step] = past(hull, spot, way, ring[1]) if hull[0] > 0.0 else 1.0
        scratch[WEIGHT + step] = axis[0] * way[0] + axis[1] * way[1] + axis[2] * way[2]
    used = False
    for step in range(ROUND):
        cosine, free = scratch[WEIGHT + step], scratch[UNHIDDEN + step]
        scratch[WEIGHT + step] = 0.0
        if cosine > eye.least and cosine > 0.0 and free > 0.0:
            scratch[WEIGHT + step] = ring[0] * free * cosine**eye.exponent
            used = True
    return used


def product(scratch: Scratch, a: int, b: int) -> float:
    """Return the scalar product of two rows; four sums at once, as none waits for another."""
    first, second, third, fourth = 0.0, 0.0, 0.0, 0.0
    for step in range(0, ROUND, 4):
        first += scratch[a + step] * scratch[b + step]
        second += scratch[a + step + 1] * scratch[b + step + 1]
        third += scratch[a + step + 2] * scratch[b + step + 2]
        fourth += scratch[a + step + 3] * scratch[b + step + 3]
    return (first + second) + (third + fourth)


def middle(position: Vector, q: Quaternion, planes: Rows) -> Vector:
    """Return the middle of the diodes, which sees what all of them see. [m, map]"""
    x, y, z = 0.0, 0.0, 0.0
    for i in range(len(planes)):
        x += planes[i][0] / len(planes)
        y += planes[i][1] / len(planes)
        z += planes[i][2] / len(planes)
    x, y, z = to_map(rotation(q), (x, y, z))
    return position[0] + x, position[1] + y, position[2] + z


def gather(
    s: Surround,
    lamps: Rows,
    eye: Eye,
    hull: Vector,
    position: Vector,
    q: Quaternion,
    planes: Rows,
    out: Array,
    scratch: Scratch,
) -> None:
    """
    Write what each diode reads of all that is not the lamps' direct light.

    Parameters
    ----------
    s : Surround
        The scene.
    lamps : ndarray, shape (l, 11), or tuples
        A row each in the order of `Beam`.
    eye : Eye
        Of the diodes.
    hull : tuple of float
        Half axes of the hull. [m]
    position, q : tuple of float
        Of the hull. [m, map]
    planes : ndarray, shape (d, 6), or tuples
        Points [m] and unit axes, body frame.
    out : ndarray, shape (LAMPS + l, d)
        In its rows: SHARE, what it reads of light that comes alike from all sides, as part of its
        illuminance; DAY, sun and sky [lx]; from LAMPS on, the echo of each lamp [lx].
    scratch : sequence of float
        `scratch_for(l)` numbers to write on.

    """
    r, point = rotation(q), middle(position, q, planes)
    for row in range(len(out)):
        for i in range(len(planes)):
            out[row, i] = 0.0
    turned(scratch)
    for ring in RINGS:
        brought(s, lamps, point, ring, scratch)
        for i in range(len(planes)):
            spot = (planes[i][0], planes[i][1], planes[i][2])
            axis = (planes[i][3], planes[i][4], planes[i][5])
            if let_in(eye, hull, r, spot, axis, ring, scratch):
                for row in range(len(out)):
                    out[row, i] += product(scratch, WEIGHT, BROUGHT + ROUND * row)
    if within(s, point[0], point[1], point[2]):
        for k in range(len(lamps)):
            for i in range(len(planes)):
                out[LAMPS + k, i] += beam_of(lamps[k]).beyond * out[SHARE, i]
    if sunlit(s, point):
        way = to_body(r, (s.sun_x, s.sun_y, s.sun_z))
        for i in range(len(planes)):
            part = seen(eye, (planes[i][3], planes[i][4], planes[i][5]), way)
            if part > 0.0:
                spot = (planes[i][0], planes[i][1], planes[i][2])
                out[DAY, i] += s.sun * part * visible(hull, spot, way, SUN_RADIUS)
