"""
What the photodiodes of a vehicle read on its way through a block of samples.

Direct light is taken at every pose on the way, past the vehicle's own hull; what is gathered from
all around (`lta_model.light.ray_integration`) at the two ends alone, and between them it is taken
to change evenly.

Plain functions of numbers and arrays, which compile.
"""

import math

from lta_model.effects.protocol import Quaternion, Vector
from lta_model.light.lambertian import (
    angular_response,
    Array,
    DiodeResponse,
    direct_light,
    LampBeam,
    unpack_beam,
)
from lta_model.light.ray_bundles import DAY, LAMPS, Rows, SHARE
from lta_model.light.scene_geometry import is_path_clear, SceneGeometry
from lta_model.light.shade import visible_fraction
from lta_model.rigid_body import rotation_matrix, to_body, to_map

DIRECT = 0.5  # rad: wider than this the disc of a lamp is never seen from a vehicle


def unobstructed_light(
    s: SceneGeometry, lamp: LampBeam, point: Vector
) -> tuple[float, Vector, float]:
    """Return the direct light on a facing plane [lx], the way to it, and its half width [rad]."""
    light, towards = direct_light(lamp, point)
    x, y, z = lamp.x - point[0], lamp.y - point[1], lamp.z - point[2]
    distance = math.sqrt(x * x + y * y + z * z)
    if light == 0.0 or not is_path_clear(s, point, towards, distance):
        return 0.0, towards, DIRECT
    return light, towards, min(math.sqrt(lamp.square) / distance, DIRECT)


def add_direct_readings(
    s: SceneGeometry,
    lamps: Rows,
    eye: DiodeResponse,
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
        A row each in the order of `LampBeam`.
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
    r = rotation_matrix(q)
    for i in range(len(planes)):
        spot = (planes[i][0], planes[i][1], planes[i][2])
        axis = (planes[i][3], planes[i][4], planes[i][5])
        x, y, z = to_map(r, spot)
        point = (position[0] + x, position[1] + y, position[2] + z)
        for k in range(len(lamps)):
            light, towards, width = unobstructed_light(s, unpack_beam(lamps[k]), point)
            if light > 0.0:
                way = to_body(r, towards)
                part = angular_response(eye, axis, way)
                if part > 0.0:
                    out[first + k, i] += light * part * visible_fraction(hull, spot, way, width)


def write_pose_readings(
    s: SceneGeometry,
    lamps: Rows,
    eye: DiodeResponse,
    hull: Vector,
    poses: Array,
    planes: Rows,
    before: Array,
    later: Array,
    ambient: Vector,
    modulated: Array,
    steady: Array,
    mains: Array,
) -> None:
    """
    Write what each diode reads at several poses, one after the other.

    Parameters
    ----------
    s, lamps, eye, hull, planes
        As `add_direct_readings`.
    poses : ndarray, shape (k, 7)
        Position [m] and quaternion x y z w, body -> map.
    before, later : ndarray, shape (LAMPS + l, d)
        What was gathered at the first and at the last of them.
    ambient : tuple of float
        The ambient light and the amplitude of its flicker [lx], and how many lux of it are worth
        one of daylight.
    modulated : ndarray, shape (l, k, d)
        Light of each lamp while it is on. [lx]
    steady, mains : ndarray, shape (k, d)
        Mean of the ambient light, and amplitude of its flicker. [lx]

    """
    for k in range(len(poses)):
        part = k / max(len(poses) - 1, 1)
        for i in range(len(planes)):
            share = before[SHARE, i] + part * (later[SHARE, i] - before[SHARE, i])
            day = before[DAY, i] + part * (later[DAY, i] - before[DAY, i])
            steady[k, i] = ambient[0] * share + ambient[2] * day
            mains[k, i] = ambient[1] * share
            for lamp in range(len(lamps)):
                echo = later[LAMPS + lamp, i] - before[LAMPS + lamp, i]
                modulated[lamp, k, i] = before[LAMPS + lamp, i] + part * echo
        position = (poses[k, 0], poses[k, 1], poses[k, 2])
        q = (poses[k, 3], poses[k, 4], poses[k, 5], poses[k, 6])
        add_direct_readings(s, lamps, eye, hull, position, q, planes, modulated[:, k], 0)
