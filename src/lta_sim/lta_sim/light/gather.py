"""
What the photodiodes of a vehicle read of everything around it, its own hull's shade included.

Direct light goes from source to diode. All other light is gathered over the sphere, as the sum of
what pencils of rays bring: rings that are narrow about the horizon, where far floor, far walls and
the edge of the hull's shade lie, and wide elsewhere. A pencil that meets a surface brings the
light that the lamp throws on it there, times its albedo (a Lambertian surface has the luminance
E / pi); what has been thrown back more than once comes from all of the room alike.

Plain functions of numbers and arrays, which compile. Left out: the shade that the hull throws on
surfaces, and daylight that a room throws on.
"""

import itertools
import math

from lta_sim.effects.protocol import Quaternion, Vector
from lta_sim.light.lambertian import Array, Beam, beam_of, Eye, seen, shine
from lta_sim.light.shade import visible
from lta_sim.light.surround import clear, daylit, Hit, hit, sunlit, Surround, within
from lta_sim.rigid_body import rotation, to_body, to_map

Rows = Array | tuple[tuple[float, ...], ...]

# Edges of the rings over the horizon, and below it [deg]; pencils in each; rays of one each way.
EDGES = (0.0, 2.0, 4.5, 8.0, 13.0, 20.0, 30.0, 45.0, 65.0, 90.0)
ROUND, PARTS = 24, 2
SUN_RADIUS = 4.7e-3  # rad, as seen from the earth
DIRECT = 0.5  # rad: wider than this the disc of a lamp is never seen from a vehicle
# Rows of what is gathered: scratch, the share of light from all sides, daylight, then the lamps.
SCRATCH, SHARE, DAY, LAMPS = range(4)


def rings() -> tuple[tuple[float, ...], ...]:
    """
    Return the rings of pencils.

    Returns
    -------
    tuple of tuple of float
        Of each ring: the solid angle of a pencil over pi, half its height [rad], then sine and
        cosine of the elevation of its middle and of its rays.

    """
    found = []
    for low, high in itertools.pairwise(EDGES):
        below, above = math.sin(math.radians(low)), math.sin(math.radians(high))
        size = 2.0 / ROUND * (above - below)
        shares = (0.5, *((k + 0.5) / PARTS for k in range(PARTS)))
        for side in (1.0, -1.0):
            ups = [side * (below + share * (above - below)) for share in shares]
            ways = [number for up in ups for number in (up, math.sqrt(1.0 - up * up))]
            found.append((size, 0.5 * math.radians(high - low), *ways))
    return tuple(found)


def around(count: int) -> tuple[tuple[float, float], ...]:
    """Return cosine and sine of the middles of so many parts of a turn."""
    turns = [2.0 * math.pi * (k + 0.5) / count for k in range(count)]
    return tuple((math.cos(turn), math.sin(turn)) for turn in turns)


RINGS, PENCILS, RAYS = rings(), around(ROUND), around(ROUND * PARTS)


def thrown_back(s: Surround, met: Hit, lamp: Beam) -> float:
    """Return the luminance of a surface by the direct light of a lamp, times pi. [lx]"""
    light, towards = shine(lamp, (met.x, met.y, met.z))
    cosine = towards[0] * met.i + towards[1] * met.j + towards[2] * met.k
    if met.albedo == 0.0 or light == 0.0 or cosine <= 0.0:
        return 0.0
    x, y, z = lamp.x - met.x, lamp.y - met.y, lamp.z - met.z
    if not clear(s, (met.x, met.y, met.z), towards, math.sqrt(x * x + y * y + z * z)):
        return 0.0
    return met.albedo * light * cosine


def straight(s: Surround, lamp: Beam, point: Vector) -> tuple[float, Vector, float]:
    """Return the direct light on a facing plane [lx], the way to it, and its half width [rad]."""
    light, towards = shine(lamp, point)
    x, y, z = lamp.x - point[0], lamp.y - point[1], lamp.z - point[2]
    distance = math.sqrt(x * x + y * y + z * z)
    if light == 0.0 or not clear(s, point, towards, distance):
        return 0.0, towards, DIRECT
    return light, towards, min(math.sqrt(lamp.square) / distance, DIRECT)


def on_diodes(
    s: Surround,
    lamps: Rows,
    eye: Eye,
    hull: Vector,
    position: Vector,
    q: Quaternion,
    planes: Rows,
    out: Array,
    first: int,
) -> None:
    """
    Add what each diode reads directly of each lamp to some rows of a table.

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
    out : ndarray, shape (r, d)
        From row `first` on, a row a lamp while it is on. [lx]
    first : int
        Which.

    """
    r = rotation(q)
    for i in range(len(planes)):
        spot = (planes[i][0], planes[i][1], planes[i][2])
        axis = (planes[i][3], planes[i][4], planes[i][5])
        x, y, z = to_map(r, spot)
        point = (position[0] + x, position[1] + y, position[2] + z)
        for k in range(len(lamps)):
            light, towards, width = straight(s, beam_of(lamps[k]), point)
            if light > 0.0:
                way = to_body(r, towards)
                part = seen(eye, axis, way)
                if part > 0.0:
                    out[first + k, i] += light * part * visible(hull, spot, way, width)


def on_the_way(
    s: Surround,
    lamps: Rows,
    eye: Eye,
    hull: Vector,
    poses: Array,
    planes: Rows,
    out: Array,
) -> None:
    """
    Add what each diode reads directly of each lamp at several poses.

    Parameters
    ----------
    s, lamps, eye, hull, planes
        As `on_diodes`.
    poses : ndarray, shape (k, 7)
        Position [m] and quaternion x y z w, body -> map.
    out : ndarray, shape (k, LAMPS + l, d)
        As `gather`.

    """
    for k in range(len(poses)):
        position = (poses[k, 0], poses[k, 1], poses[k, 2])
        q = (poses[k, 3], poses[k, 4], poses[k, 5], poses[k, 6])
        on_diodes(s, lamps, eye, hull, position, q, planes, out[k], LAMPS)


def gather(
    s: Surround,
    lamps: Rows,
    eye: Eye,
    hull: Vector,
    position: Vector,
    q: Quaternion,
    planes: Rows,
    out: Array,
) -> None:
    """
    Write what each diode reads of all that is not the lamps' direct light.

    Parameters
    ----------
    s, lamps, eye, hull, position, q, planes
        As `on_diodes`.
    out : ndarray, shape (LAMPS + l, d)
        In its rows: SHARE, what it reads of light that comes alike from all sides, as part of its
        illuminance; DAY, sun and sky [lx]; from LAMPS on, the echo of each lamp [lx].

    """
    r, centre = rotation(q), (0.0, 0.0, 0.0)
    for row in range(len(out)):
        for i in range(len(planes)):
            out[row, i] = 0.0
    for i in range(len(planes)):  # the middle of the diodes sees what all of them see
        centre = (
            centre[0] + planes[i][0] / len(planes),
            centre[1] + planes[i][1] / len(planes),
            centre[2] + planes[i][2] / len(planes),
        )
    x, y, z = to_map(r, centre)
    point = (position[0] + x, position[1] + y, position[2] + z)
    indoors = within(s, point[0], point[1], point[2])
    for ring in RINGS:
        for step in range(ROUND):
            c, d = PENCILS[step]
            way = to_body(r, (ring[3] * c, ring[3] * d, ring[2]))
            used = False
            for i in range(len(planes)):
                part = seen(eye, (planes[i][3], planes[i][4], planes[i][5]), way)
                if part > 0.0:
                    spot = (planes[i][0], planes[i][1], planes[i][2])
                    part *= ring[0] * visible(hull, spot, way, ring[1])
                    used = used or part > 0.0
                out[SCRATCH, i] = part
                out[SHARE, i] += part
            for ray in range(PARTS * PARTS if used else 0):
                row = 4 + 2 * (ray // PARTS)
                c, d = RAYS[PARTS * step + ray % PARTS]
                met, inside = hit(s, point, (ring[row + 1] * c, ring[row + 1] * d, ring[row]))
                day = daylit(s, inside, ring[row]) / (PARTS * PARTS)
                for i in range(len(planes)):
                    out[DAY, i] += day * out[SCRATCH, i]
                for k in range(len(lamps)):
                    bright = thrown_back(s, met, beam_of(lamps[k])) / (PARTS * PARTS)
                    for i in range(len(planes)):
                        out[LAMPS + k, i] += bright * out[SCRATCH, i]
    if indoors:
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
