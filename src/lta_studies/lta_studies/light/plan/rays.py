"""
How much light of a lamp the ring of photodiodes gets over every cell, at its worst heading.

Plain functions of numbers, compiled: the light is that of `lta_model.light.lambertian`, direct
alone. What hides a lamp is the drone's own hull above the ring, walls, and whatever stands on the
floor; the line of sight of all diodes is that of the middle of their ring.
"""

import math

from lta_model.effects.protocol import Vector
from lta_model.light.lambertian import angular_response, DiodeResponse, direct_light, LampBeam
from lta_model.light.shade import visible_fraction
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
NEARLY = 1.0 - 1e-6  # of the way to a lamp: it may hang on a wall


def diode_light(
    lamp: LampBeam,
    eye: DiodeResponse,
    cosine: float,
    sine: float,
    centre: Vector,
    spot: Vector,
    axis: Vector,
    half_axes: Vector,
) -> float:
    """
    Return the light that a diode of a level drone reads of a lamp past its own hull. [lx]

    Parameters
    ----------
    lamp : Beam
        The lamp, without any room.
    eye : Eye
        Of the diode.
    cosine, sine : float
        Of the heading.
    centre : tuple of float
        Hull centre. [m]
    spot, axis : tuple of float
        Place [m] and axis of the diode, body frame.
    half_axes : tuple of float
        Of the hull. [m]

    """
    x, y, z = spot
    light, (a, b, c) = direct_light(
        lamp, (centre[0] + cosine * x - sine * y, centre[1] + sine * x + cosine * y, centre[2] + z)
    )
    towards = (cosine * a + sine * b, cosine * b - sine * a, c)
    part = angular_response(eye, axis, towards)
    if light <= 0.0 or part <= 0.0:
        return 0.0
    # As small as it is from so far: the light told, the lamp is that bright at the distance.
    u, v, w = lamp.x - centre[0], lamp.y - centre[1], lamp.z - centre[2]
    width = math.sqrt(lamp.square / (u * u + v * v + w * w + lamp.square))
    return light * part * visible_fraction(half_axes, spot, towards, width)


def is_blocked(start: Vector, end: Vector, walls: Array) -> bool:
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


def light_extremes(
    lamp: LampBeam,
    eye: DiodeResponse,
    centre: Vector,
    planes: Array,
    half_axes: Vector,
    headings: Array,
) -> tuple[float, float]:
    """
    Return the light on the diode that reads most of a lamp: at the worst heading and the best.

    Parameters
    ----------
    lamp : Beam
        The lamp, without any room.
    eye : Eye
        Of the diodes.
    centre : tuple of float
        Hull centre of a drone that flies level. [m]
    planes : ndarray, shape (d, 8)
        Places [m] and axes of the diodes, body frame; their gains, none where one is dead; and
        which part each reads of light that comes alike from all sides.
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
    for h in range(headings.shape[0]):
        best = 0.0
        for k in range(planes.shape[0]):
            if planes[k, 6] > 0.0:
                spot = (planes[k, 0], planes[k, 1], planes[k, 2])
                axis = (planes[k, 3], planes[k, 4], planes[k, 5])
                light = diode_light(
                    lamp, eye, headings[h, 0], headings[h, 1], centre, spot, axis, half_axes
                )
                best = max(best, planes[k, 6] * light)
        least, most = min(least, best), max(most, best)
    return least, most


def compute_cell_light(
    lamp: LampBeam,
    eye: DiodeResponse,
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
        As `is_blocked` takes them.
    planes, half_axes, headings
        As `light_extremes` takes them.
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
        bright, _ = direct_light(lamp, ring)
        if bright >= faintest and not is_blocked(ring, (lamp.x, lamp.y, lamp.z), walls):
            out[0, k], out[1, k] = light_extremes(
                lamp, eye, (x, y, z), planes, half_axes, headings
            )
