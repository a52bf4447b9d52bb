"""
Compute the share of a lamp's light that the surfaces of a room reflect.

The light on each face is summed over a grid. In a room without a door all of the flux reaches its
faces, so there the sum is scaled to the known total.
"""

from functools import lru_cache

from lta_config.compilation.compiler import compile_functions
from lta_model.light.field import LightField
from lta_model.light.lambertian import build_beam, LampBeam
from lta_model.light.lamp import BeaconLamp
from lta_model.light.ray_bundles import reflected_luminance
from lta_model.light.scene_geometry import build_scene_geometry, is_in_door, RayHit, SceneGeometry
import numpy as np
from numpy.typing import NDArray

GRID = 64  # cells along each edge of a face


def build_field_geometry(field: LightField) -> SceneGeometry:
    """Return room, door and daylight of a scene as numbers."""
    return build_scene_geometry(field.room, field.daylight, field.outside)


def integrate_reflected_flux(s: SceneGeometry, lamp: LampBeam, cells: int) -> tuple[float, float]:
    """Return a lamp's flux on all faces of a room, and the reflected part of it. [lm]"""
    # Midpoint rule over a grid on each face
    fallen, thrown = 0.0, 0.0
    for face in range(6):
        for row in range(cells):
            for column in range(cells):
                # Cell centres, -1 to 1 across a face
                a = 2.0 * (row + 0.5) / cells - 1.0
                b = 2.0 * (column + 0.5) / cells - 1.0
                side = 1.0 if face % 2 == 0 else -1.0
                up = 0.5 * s.height * (1.0 + b)
                # Ceiling and floor, then the walls across x, then those across y
                if face < 2:
                    albedo = s.ceiling if side > 0.0 else s.floor
                    height = s.height if side > 0.0 else 0.0
                    # Albedo 1, to get the incident flux
                    met = RayHit(a * s.x, b * s.y, height, 0.0, 0.0, -side, 1.0)
                    area = 4.0 * s.x * s.y
                elif face < 4:
                    albedo = s.walls
                    met = RayHit(side * s.x, a * s.y, up, -side, 0.0, 0.0, 1.0)
                    area = 2.0 * s.y * s.height
                    # Light leaves through the door
                    if is_in_door(s, met.x, met.y, met.z):
                        albedo = 0.0
                else:
                    albedo = s.walls
                    met = RayHit(a * s.x, side * s.y, up, 0.0, -side, 0.0, 1.0)
                    area = 2.0 * s.x * s.height
                flux = reflected_luminance(s, met, lamp) * area / (cells * cells)
                fallen += flux
                thrown += albedo * flux
    return fallen, thrown


@lru_cache(maxsize=256)
def build_reflecting_beam(lamp: BeaconLamp, field: LightField) -> LampBeam:
    """Return a lamp of a scene as numbers, with the light reflected by the room."""
    bare = build_beam(lamp)
    if field.room is None or not lamp.flux:
        return bare
    fallen, thrown = compile_functions(integrate_reflected_flux)[0](
        build_field_geometry(field), bare, GRID
    )
    # Closed room: scale to the known total flux
    if field.outside is None and fallen > 0.0:
        thrown *= lamp.flux / fallen
    return build_beam(lamp, field.room, thrown)


def pack_beams(field: LightField) -> NDArray[np.float64]:
    """Return the lamps of a scene, a row each in the order of `LampBeam`, shape (l, 11)."""
    return np.array([build_reflecting_beam(lamp, field) for lamp in field.lamps])
