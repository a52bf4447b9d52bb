"""
How much of a lamp's light the surfaces of a room throw back, and the lamp as numbers with it.

The light on each face is summed over a grid. In a room without a door all of the flux falls on its
faces: there the sum only says how it is shared among them.
"""

from functools import lru_cache

from lta_config.compilation.compiled import compiled
from lta_model.light.field import LightField
from lta_model.light.lambertian import Beam, beam
from lta_model.light.lamp import Lamp
from lta_model.light.pencils import thrown_back
from lta_model.light.surround import Hit, in_door, Surround, surround_of
import numpy as np
from numpy.typing import NDArray

GRID = 64  # cells along each edge of a face


def surrounding(field: LightField) -> Surround:
    """Return what stands around, as numbers."""
    return surround_of(field.room, field.daylight, field.outside)


def on_faces(s: Surround, lamp: Beam, cells: int) -> tuple[float, float]:
    """Return the flux of a lamp on all faces of a room, and what of it they throw back. [lm]"""
    fallen, thrown = 0.0, 0.0
    for face in range(6):
        for row in range(cells):
            for column in range(cells):
                a = 2.0 * (row + 0.5) / cells - 1.0
                b = 2.0 * (column + 0.5) / cells - 1.0
                side = 1.0 if face % 2 == 0 else -1.0
                up = 0.5 * s.height * (1.0 + b)
                if face < 2:
                    albedo = s.ceiling if side > 0.0 else s.floor
                    height = s.height if side > 0.0 else 0.0
                    met = Hit(a * s.x, b * s.y, height, 0.0, 0.0, -side, 1.0)
                    area = 4.0 * s.x * s.y
                elif face < 4:
                    albedo = s.walls
                    met = Hit(side * s.x, a * s.y, up, -side, 0.0, 0.0, 1.0)
                    area = 2.0 * s.y * s.height
                    if in_door(s, met.x, met.y, met.z):
                        albedo = 0.0
                else:
                    albedo = s.walls
                    met = Hit(a * s.x, side * s.y, up, 0.0, -side, 0.0, 1.0)
                    area = 2.0 * s.x * s.height
                flux = thrown_back(s, met, lamp) * area / (cells * cells)
                fallen += flux
                thrown += albedo * flux
    return fallen, thrown


@lru_cache(maxsize=256)
def echoing(lamp: Lamp, field: LightField) -> Beam:
    """Return a lamp of a scene as numbers, with what the room throws back."""
    bare = beam(lamp)
    if field.room is None or not lamp.flux:
        return bare
    fallen, thrown = compiled(on_faces)[0](surrounding(field), bare, GRID)
    if field.outside is None and fallen > 0.0:
        thrown *= lamp.flux / fallen
    return beam(lamp, field.room, thrown)


def beams(field: LightField) -> NDArray[np.float64]:
    """Return the lamps of a scene, a row each in the order of `Beam`, shape (l, 11)."""
    return np.array([echoing(lamp, field) for lamp in field.lamps])
