"""
Compute the photodiode readings of a moving vehicle during a block of samples.

Direct light is computed at every pose, with shading by the vehicle's own hull; indirect light
(`lta_model.light.ray_integration`) only at both ends, with linear interpolation between them.
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
    """Return the direct light on a facing plane [lx], its direction, and its half width [rad]."""
    light, towards = direct_light(lamp, point)
    x, y, z = lamp.x - point[0], lamp.y - point[1], lamp.z - point[2]
    distance = math.sqrt(x * x + y * y + z * z)
    if light == 0.0 or not is_path_clear(s, point, towards, distance):
        # The width is not used without light; any positive one avoids a division by zero
        return 0.0, towards, DIRECT
    # Half the angular width of the lamp's disc, as seen from the point
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
    Add each diode's reading of each lamp's direct light to rows of a table.

    Parameters
    ----------
    lamps : ndarray, shape (l, 11), or tuples
        Rows in the order of `LampBeam`.
    hull : tuple of float
        Half axes of the hull. [m]
    position, q : tuple of float
        Pose of the hull. [m, map]
    planes : ndarray, shape (d, 6), or tuples
        Points [m] and unit axes of the diodes, body frame.
    out : ndarray, shape (r, d)
        From row `first` on, a row for each lamp while it is on. [lx]

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
                # Shading by the hull is computed only for light that the diode sees
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
    Write each diode's readings at several poses.

    Parameters
    ----------
    s, lamps, eye, hull, planes
        As `add_direct_readings`.
    poses : ndarray, shape (k, 7)
        Position [m] and quaternion x y z w, body -> map.
    before, later : ndarray, shape (LAMPS + l, d)
        Indirect light at the first and at the last pose.
    ambient : tuple of float
        Ambient light, amplitude of its flicker [lx], and lux of it that equal one lux of daylight.
    modulated : ndarray, shape (l, k, d)
        Light of each lamp while it is on. [lx]
    steady, mains : ndarray, shape (k, d)
        Mean of the ambient light, and amplitude of its flicker. [lx]

    """
    for k in range(len(poses)):
        # Position in the block, 0 to 1
        part = k / max(len(poses) - 1, 1)
        for i in range(len(planes)):
            share = before[SHARE, i] + part * (later[SHARE, i] - before[SHARE, i])
            day = before[DAY, i] + part * (later[DAY, i] - before[DAY, i])
            steady[k, i] = ambient[0] * share + ambient[2] * day
            mains[k, i] = ambient[1] * share
            for lamp in range(len(lamps)):
                # Indirect light of the lamp, interpolated between the two ends
                echo = later[LAMPS + lamp, i] - before[LAMPS + lamp, i]
                modulated[lamp, k, i] = before[LAMPS + lamp, i] + part * echo
        position = (poses[k, 0], poses[k, 1], poses[k, 2])
        q = (poses[k, 3], poses[k, 4], poses[k, 5], poses[k, 6])
        add_direct_readings(s, lamps, eye, hull, position, q, planes, modulated[:, k], 0)
