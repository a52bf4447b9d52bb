# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute the light of a lamp on the photodiode ring over every cell, at the worst heading.

These functions are compiled. Only direct light counts (`lta_model.light.direct_light`). A lamp can
be hidden by the drone's own hull, by walls and by obstacles. For walls and obstacles, the line of
sight of the ring's centre stands for all diodes.
"""

import math

from lta_model.effects.protocol import Vector
from lta_model.light.direct_light import (
    angular_response,
    DiodeResponse,
    direct_light,
    LampBeam,
    visible_fraction,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
RAY_END = 1.0 - 1e-6  # end rays just before the lamp, which may be on a wall


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
    Return the light of a lamp on a diode of a level drone, shaded by its own hull [lx].

    Parameters
    ----------
    lamp : LampBeam
        The lamp, without room.
    cosine, sine : float
        Cosine and sine of the heading.
    centre : tuple of float
        Hull centre. [m]
    spot, axis : tuple of float
        Position [m] and axis of the diode, body frame.
    half_axes : tuple of float
        Half axes of the hull. [m]

    """
    x, y, z = spot
    light, (a, b, c) = direct_light(
        lamp, (centre[0] + cosine * x - sine * y, centre[1] + sine * x + cosine * y, centre[2] + z)
    )
    # Direction of the lamp, rotated into the body frame
    towards = (cosine * a + sine * b, cosine * b - sine * a, c)
    part = angular_response(eye, axis, towards)
    if light <= 0.0 or part <= 0.0:
        return 0.0
    # Angular radius of the lamp, for its penumbra at the edge of the hull.
    u, v, w = lamp.x - centre[0], lamp.y - centre[1], lamp.z - centre[2]
    width = math.sqrt(lamp.square / (u * u + v * v + w * w + lamp.square))
    return light * part * visible_fraction(half_axes, spot, towards, width)


def is_blocked(start: Vector, end: Vector, walls: Array) -> bool:
    """
    Return whether a line meets one of the vertical faces `walls`, rows x0 y0 x1 y1 height.

    Closed obstacles need no top face: a ray through the top also passes a side below its height.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    for k in range(walls.shape[0]):
        ex, ey = walls[k, 2] - walls[k, 0], walls[k, 3] - walls[k, 1]
        # Cross product of ray and wall; 0 if parallel
        across = dx * ey - dy * ex
        if across == 0.0:
            continue
        fx, fy = walls[k, 0] - start[0], walls[k, 1] - start[1]
        # Position of the intersection along the ray and along the wall, each from 0 to 1
        along = (fx * ey - fy * ex) / across
        part = (fx * dy - fy * dx) / across
        if (
            0.0 < along < RAY_END
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
    Return the light on the brightest diode at the worst and the best heading.

    Parameters
    ----------
    lamp : LampBeam
        The lamp, without room.
    centre : tuple of float
        Hull centre of a level drone. [m]
    planes : ndarray, shape (d, 8)
        Positions [m] and axes of the diodes in the body frame, their gains (0 if dead), and their
        shares of isotropic ambient light.
    half_axes : tuple of float
        Half axes of the hull. [m]
    headings : ndarray, shape (h, 2)
        Cosine and sine of each heading.

    Returns
    -------
    tuple of float
        Minimum and maximum; 0 if no diode sees the lamp. [lx]

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
    Compute the light of one lamp over all cells.

    Parameters
    ----------
    lamp : LampBeam
        The lamp, without room.
    cells : ndarray, shape (m, 3)
        Hull centres. [m]
    walls : ndarray, shape (w, 5)
        As in `is_blocked`.
    planes, half_axes, headings
        As in `light_extremes`.
    faintest : float
        Cells with less direct light are skipped, as they cannot receive the lamp. [lx]
    out : ndarray, shape (2, m)
        Output: minimum and maximum over the headings; 0 if hidden or fainter. [lx]

    """
    level = 0.0
    for k in range(planes.shape[0]):
        # Mean height of the ring relative to the hull centre
        level += planes[k, 2] / planes.shape[0]
    for k in range(cells.shape[0]):
        x, y, z = cells[k, 0], cells[k, 1], cells[k, 2]
        out[0, k] = out[1, k] = 0.0
        ring = (x, y, z + level)
        # Light on a plane that faces the lamp: too faint here is too faint for every diode.
        bright, _ = direct_light(lamp, ring)
        if bright >= faintest and not is_blocked(ring, (lamp.x, lamp.y, lamp.z), walls):
            out[0, k], out[1, k] = light_extremes(
                lamp, eye, (x, y, z), planes, half_axes, headings
            )
