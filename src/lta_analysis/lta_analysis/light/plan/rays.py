"""
How much light of a lamp the ring of photodiodes gets over every cell, at its worst heading.

Plain functions of numbers, compiled: the light is that of `lta_sim.light.lambertian`, direct
alone. What hides a lamp is the drone's own hull above the ring, walls, and whatever stands on the
floor; the line of sight of all diodes is that of the middle of their ring.
"""

import math

from lta_sim.effects.protocol import Vector
from lta_sim.light.lambertian import Array, Beam, Eye, read, shine

NEARLY = 1.0 - 1e-6  # of the way to a lamp: it may hang on a wall


def hidden(point: Vector, ray: Vector, half_axes: Vector) -> bool:
    """
    Return whether the hull stands between a point outside it and what lies along a ray.

    Parameters
    ----------
    point : tuple of float
        Where one looks from, body frame. [m]
    ray : tuple of float
        Along which one looks, of any length but zero. [body]
    half_axes : tuple of float
        Of the hull, an ellipsoid around the origin; zeros where there is none. [m]

    """
    a, b, c = half_axes
    if a <= 0.0 or b <= 0.0 or c <= 0.0:
        return False
    x, y, z = point[0] / a, point[1] / b, point[2] / c
    u, v, w = ray[0] / a, ray[1] / b, ray[2] / c
    towards = x * u + y * v + z * w
    outside = x * x + y * y + z * z - 1.0
    return towards < 0.0 and towards * towards >= outside * (u * u + v * v + w * w)


def blocked(start: Vector, end: Vector, walls: Array) -> bool:
    """
    Return whether a straight line meets one of the upright faces `walls`, rows x0 y0 x1 y1 height.

    What is closed on all sides needs no top: who passes through it leaves by a side below.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    for k in range(walls.shape[0]):
        ex, ey = walls[k, 2] - walls[k, 0], walls[k, 3] - walls[k, 1]
        across = dx * ey - dy * ex
        if across == 0.0:
            continue
        fx, fy = walls[k, 0] - start[0], walls[k, 1] - start[1]
        along = (fx * ey - fy * ex) / across
        part = (fx * dy - fy * dx) / across
        if (
            0.0 < along < NEARLY
            and 0.0 <= part <= 1.0
            and start[2] + along * (end[2] - start[2]) < walls[k, 4]
        ):
            return True
    return False


def extremes(
    lamp: Beam, eye: Eye, centre: Vector, planes: Array, half_axes: Vector, headings: Array
) -> tuple[float, float]:
    """
    Return the light on the diode that faces a lamp most: at the worst heading and at the best.

    Parameters
    ----------
    lamp : Beam
        The lamp, without any room.
    eye : Eye
        Of the diodes.
    centre : tuple of float
        Hull centre of a drone that flies level. [m]
    planes : ndarray, shape (d, 7)
        Places [m], axes and gains of the diodes, body frame; a dead one has none.
    half_axes : tuple of float
        Of the hull. [m]
    headings : ndarray, shape (h, 2)
        Cosine and sine of each heading to look at.

    Returns
    -------
    tuple of float
        Least and most; 0 where no diode sees the lamp. [lx]

    """
    least, most = math.inf, 0.0
    a, b, c = lamp.x - centre[0], lamp.y - centre[1], lamp.z - centre[2]
    for h in range(headings.shape[0]):
        cosine, sine = headings[h, 0], headings[h, 1]
        x, y = cosine * a + sine * b, cosine * b - sine * a  # of the lamp, body frame
        chosen, facing = -1, 0.0
        for k in range(planes.shape[0]):
            u, v, w = x - planes[k, 0], y - planes[k, 1], c - planes[k, 2]
            faces = u * planes[k, 3] + v * planes[k, 4] + w * planes[k, 5]
            if faces > facing and planes[k, 6] > 0.0:
                spot = (planes[k, 0], planes[k, 1], planes[k, 2])
                if not hidden(spot, (u, v, w), half_axes):
                    chosen, facing = k, faces
        light = 0.0
        if chosen >= 0:
            i, j = planes[chosen, 0], planes[chosen, 1]
            p, q = planes[chosen, 3], planes[chosen, 4]
            light = planes[chosen, 6] * read(
                lamp,
                eye,
                (
                    centre[0] + cosine * i - sine * j,
                    centre[1] + sine * i + cosine * j,
                    centre[2] + planes[chosen, 2],
                ),
                (cosine * p - sine * q, sine * p + cosine * q, planes[chosen, 5]),
            )
        least, most = min(least, light), max(most, light)
    return least, most


def over_cells(
    lamp: Beam,
    eye: Eye,
    cells: Array,
    walls: Array,
    planes: Array,
    half_axes: Vector,
    headings: Array,
    faintest: float,
    out: Array,
) -> None:
    """
    Write the light of one lamp over all cells.

    Parameters
    ----------
    lamp : Beam
        The lamp, without any room.
    eye : Eye
        Of the diodes.
    cells : ndarray, shape (m, 3)
        Hull centres. [m]
    walls : ndarray, shape (w, 5)
        As `blocked` takes them.
    planes, half_axes, headings
        As `extremes` takes them.
    faintest : float
        Light below which nothing is looked at more closely: nobody hears it. [lx]
    out : ndarray, shape (2, m)
        Least and most light over the headings; 0 where walls hide the lamp or it is fainter. [lx]

    """
    level = 0.0
    for k in range(planes.shape[0]):
        level += planes[k, 2] / planes.shape[0]
    for k in range(cells.shape[0]):
        x, y, z = cells[k, 0], cells[k, 1], cells[k, 2]
        out[0, k] = out[1, k] = 0.0
        ring = (x, y, z + level)
        bright, _ = shine(lamp, ring)
        if bright >= faintest and not blocked(ring, (lamp.x, lamp.y, lamp.z), walls):
            out[0, k], out[1, k] = extremes(lamp, eye, (x, y, z), planes, half_axes, headings)
