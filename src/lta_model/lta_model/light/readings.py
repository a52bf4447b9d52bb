# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Light on a vehicle's photodiodes during a block of samples, and on its solar panel.

Direct light is computed at every pose, with shading by the vehicle's own hull; indirect light
(`lta_model.light.reflected_light`) only at both ends of a block, with linear interpolation between
them. The hull may hide lamps and the sun from the panel; of diffuse light it leaves a constant
share at any pose. Plain functions of numbers and arrays, which compile.
"""

import math
from typing import NamedTuple

from lta_model.effects.protocol import Quaternion, Vector
from lta_model.light.direct_light import (
    angular_response,
    Array,
    DiodeResponse,
    direct_light,
    LampBeam,
    unpack_beam,
    visible_fraction,
)
from lta_model.light.reflected_light import (
    BUNDLE_AZIMUTHS,
    DAYLIGHT_ROW,
    LAMP_ROWS,
    RINGS,
    Rows,
    SUN_RADIUS,
    UNIFORM_ROW,
)
from lta_model.light.scene_geometry import (
    daylight_illuminance,
    is_path_clear,
    is_sunlit,
    SceneGeometry,
)
from lta_model.rigid_body import rotation_matrix, to_body, to_map

WIDEST_DISC = 0.5  # rad: wider than this the disc of a lamp is never seen from a vehicle


def unobstructed_light(
    s: SceneGeometry, lamp: LampBeam, point: Vector
) -> tuple[float, Vector, float]:
    """Return the direct light on a facing plane [lx], its direction, and its half width [rad]."""
    light, towards = direct_light(lamp, point)
    x, y, z = lamp.x - point[0], lamp.y - point[1], lamp.z - point[2]
    distance = math.sqrt(x * x + y * y + z * z)
    if light == 0.0 or not is_path_clear(s, point, towards, distance):
        # The width is not used without light; any positive one avoids a division by zero
        return 0.0, towards, WIDEST_DISC
    # Half the angular width of the lamp's disc, as seen from the point
    return light, towards, min(math.sqrt(lamp.square) / distance, WIDEST_DISC)


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
            share = before[UNIFORM_ROW, i] + part * (
                later[UNIFORM_ROW, i] - before[UNIFORM_ROW, i]
            )
            day = before[DAYLIGHT_ROW, i] + part * (
                later[DAYLIGHT_ROW, i] - before[DAYLIGHT_ROW, i]
            )
            steady[k, i] = ambient[0] * share + ambient[2] * day
            mains[k, i] = ambient[1] * share
            for lamp in range(len(lamps)):
                # Indirect light of the lamp, interpolated between the two ends
                echo = later[LAMP_ROWS + lamp, i] - before[LAMP_ROWS + lamp, i]
                modulated[lamp, k, i] = before[LAMP_ROWS + lamp, i] + part * echo
        position = (poses[k, 0], poses[k, 1], poses[k, 2])
        q = (poses[k, 3], poses[k, 4], poses[k, 5], poses[k, 6])
        add_direct_readings(s, lamps, eye, hull, position, q, planes, modulated[:, k], 0)


class PanelPlane(NamedTuple):
    """The panel on its vehicle."""

    hull: Vector  # half axes of the hull [m]
    # Middle [m] and unit normal of the panel, body frame
    spot: Vector
    normal: Vector
    share: float  # share of light from all sides that the hull leaves [1]


def build_panel_plane(hull: Vector, spot: Vector, normal: Vector) -> PanelPlane:
    """Return a panel; the share is summed over the bundles of `reflected_light`."""
    free = whole = 0.0
    # Directions of the body frame: the share is taken as the same at any attitude
    for size, half_height, up, out, *_ in RINGS:
        for c, d in BUNDLE_AZIMUTHS:
            way = (out * c, out * d, up)
            part = size * angular_response(DiodeResponse(1.0, 0.0), normal, way)
            whole += part
            if part > 0.0:
                free += part * visible_fraction(hull, spot, way, half_height)
    return PanelPlane(hull, spot, normal, free / whole)


def incidence_cosine(plane: PanelPlane, way: Vector) -> float:
    """Return the cosine between the panel's normal and a direction [body], 0 from behind."""
    return angular_response(DiodeResponse(1.0, 0.0), plane.normal, way)


def panel_center(plane: PanelPlane, position: Vector, q: Quaternion) -> Vector:
    """Return the middle of the panel [m, map]."""
    x, y, z = to_map(rotation_matrix(q), plane.spot)
    return position[0] + x, position[1] + y, position[2] + z


def lamp_light_on_panel(
    plane: PanelPlane, s: SceneGeometry, lamp: LampBeam, position: Vector, q: Quaternion
) -> float:
    """
    Return the light of a lamp on the panel while it is on, reflections included [lx].

    `position` [m] and `q` are those of the hull in `map`.
    """
    light, towards, width = unobstructed_light(s, lamp, panel_center(plane, position, q))
    if light > 0.0:
        way = to_body(rotation_matrix(q), towards)
        light *= incidence_cosine(plane, way) * visible_fraction(
            plane.hull, plane.spot, way, width
        )
    # Diffuse light comes from all sides; the hull takes a constant share
    return light + plane.share * lamp.diffuse


def daylight_on_panel(
    plane: PanelPlane, s: SceneGeometry, position: Vector, q: Quaternion
) -> float:
    """Return sun, sky and ground light on the panel; parameters as `lamp_light_on_panel` [lx]."""
    r = rotation_matrix(q)
    point, normal = panel_center(plane, position, q), to_map(r, plane.normal)
    day = daylight_illuminance(s, point, normal)
    # Only diffuse daylight is left
    if not is_sunlit(s, point):
        return plane.share * day
    way = to_body(r, (s.sun_x, s.sun_y, s.sun_z))
    sun = s.sun * incidence_cosine(plane, way)
    if sun <= 0.0:
        return plane.share * day
    # `day` contains the sun; the hull hides it or not
    return plane.share * (day - sun) + sun * visible_fraction(
        plane.hull, plane.spot, way, SUN_RADIUS
    )
