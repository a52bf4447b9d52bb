"""
Compute the light on a vehicle's solar panel, with shading by its own hull.

The hull may hide lamps and the sun; of diffuse light it leaves a constant share at any pose.
"""

from typing import NamedTuple

from lta_model.effects.protocol import Quaternion, Vector
from lta_model.light.block_readings import unobstructed_light
from lta_model.light.lambertian import angular_response, DiodeResponse, LampBeam
from lta_model.light.ray_bundles import PENCILS, RINGS
from lta_model.light.ray_integration import SUN_RADIUS
from lta_model.light.scene_geometry import daylight_illuminance, is_sunlit, SceneGeometry
from lta_model.light.shade import visible_fraction
from lta_model.rigid_body import rotation_matrix, to_body, to_map


class PanelPlane(NamedTuple):
    """The panel on its vehicle."""

    hull: Vector  # half axes of the hull [m]
    # Middle [m] and unit normal of the panel, body frame
    spot: Vector
    normal: Vector
    share: float  # share of light from all sides that the hull leaves [1]


def build_panel_plane(hull: Vector, spot: Vector, normal: Vector) -> PanelPlane:
    """Return a panel; the share is summed over the bundles of `lta_model.light.ray_bundles`."""
    free = whole = 0.0
    # Directions of the body frame: the share is taken as the same at any attitude
    for size, half_height, up, out, *_ in RINGS:
        for c, d in PENCILS:
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
    """Return the middle of the panel. [m, map]"""
    x, y, z = to_map(rotation_matrix(q), plane.spot)
    return position[0] + x, position[1] + y, position[2] + z


def lamp_light_on_panel(
    plane: PanelPlane, s: SceneGeometry, lamp: LampBeam, position: Vector, q: Quaternion
) -> float:
    """
    Return the light of a lamp on the panel while it is on, reflections included. [lx]

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
    """Return sun, sky and ground light on the panel; parameters as `lamp_light_on_panel`. [lx]"""
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
