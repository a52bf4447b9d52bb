"""
The light on the solar panel of a vehicle, its own hull's shade included.

Lamps and the sun are seen past the hull or not; of light that comes alike from all sides the hull
leaves a share, which is the same at any pose.
"""

from typing import NamedTuple

from lta_model.effects.protocol import Quaternion, Vector
from lta_model.light.gather import SUN_RADIUS
from lta_model.light.lambertian import Beam, Eye, seen
from lta_model.light.passage import straight
from lta_model.light.pencils import PENCILS, RINGS
from lta_model.light.shade import visible
from lta_model.light.surround import day_on, sunlit, Surround
from lta_model.rigid_body import rotation, to_body, to_map


class Plane(NamedTuple):
    """
    The panel on its vehicle.

    Attributes
    ----------
    hull : tuple of float
        Half axes of the hull. [m]
    spot : tuple of float
        Middle of the panel. [m, body]
    normal : tuple of float
        Where it looks, unit length. [body]
    share : float
        Part of light from all sides that the hull leaves. [1]

    """

    hull: Vector
    spot: Vector
    normal: Vector
    share: float


def plane_of(hull: Vector, spot: Vector, normal: Vector) -> Plane:
    """Return a panel; the share is summed over the pencils of `lta_model.light.pencils`."""
    free = whole = 0.0
    for size, half_height, up, out, *_ in RINGS:
        for c, d in PENCILS:
            way = (out * c, out * d, up)
            part = size * seen(Eye(1.0, 0.0), normal, way)
            whole += part
            if part > 0.0:
                free += part * visible(hull, spot, way, half_height)
    return Plane(hull, spot, normal, free / whole)


def facing(plane: Plane, way: Vector) -> float:
    """Return the cosine between the panel's normal and a direction [body], 0 from behind."""
    return seen(Eye(1.0, 0.0), plane.normal, way)


def point_of(plane: Plane, position: Vector, q: Quaternion) -> Vector:
    """Return the middle of the panel. [m, map]"""
    x, y, z = to_map(rotation(q), plane.spot)
    return position[0] + x, position[1] + y, position[2] + z


def lamp_on(plane: Plane, s: Surround, lamp: Beam, position: Vector, q: Quaternion) -> float:
    """
    Return the light of a lamp on the panel while it is on, the room's echo included. [lx]

    Parameters
    ----------
    plane : Plane
        The panel.
    s : Surround
        The scene.
    lamp : Beam
        The lamp.
    position, q : tuple of float
        Of the hull. [m, map]

    """
    light, towards, width = straight(s, lamp, point_of(plane, position, q))
    if light > 0.0:
        way = to_body(rotation(q), towards)
        light *= facing(plane, way) * visible(plane.hull, plane.spot, way, width)
    return light + plane.share * lamp.diffuse


def day_on_panel(plane: Plane, s: Surround, position: Vector, q: Quaternion) -> float:
    """Return the light of sun, sky and ground on the panel; parameters as `lamp_on`. [lx]"""
    r = rotation(q)
    point, normal = point_of(plane, position, q), to_map(r, plane.normal)
    day = day_on(s, point, normal)
    if not sunlit(s, point):
        return plane.share * day
    way = to_body(r, (s.sun_x, s.sun_y, s.sun_z))
    sun = s.sun * facing(plane, way)
    if sun <= 0.0:
        return plane.share * day
    return plane.share * (day - sun) + sun * visible(plane.hull, plane.spot, way, SUN_RADIUS)
