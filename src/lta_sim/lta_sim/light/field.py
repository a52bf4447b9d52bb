"""
All light of a scene, and what of it falls on a plane.

Map frame. In lux on a small plane at a point, part by part:

- direct light of each lamp, by the inverse square (`lamp`);
- light of the lamps between the walls of a closed room, from all sides (`room`). It flickers too;
- ambient light, from all sides: a steady part and the flicker of the mains (`ambient`).

Lux over the luminous efficacy of the light (white LED 300 lm/W, sun 105) is irradiance.
"""

from dataclasses import dataclass
from typing import final

from lta_sim.light.ambient import Ambient
from lta_sim.light.lamp import direct, Lamp
from lta_sim.light.refuse import require
from lta_sim.light.room import Room
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class LightField:
    """
    All light of a scene.

    Parameters
    ----------
    lamps : tuple of Lamp
        The beacons, at least one.
    ambient : Ambient
        The rest.
    room : Room or None
        The closed room around the lamps; None outdoors.

    """

    lamps: tuple[Lamp, ...]
    ambient: Ambient
    room: Room | None = None

    def __post_init__(self) -> None:
        """Refuse a scene without a lamp."""
        require(len(self.lamps) > 0, 'The scene has no lamp; give one.')

    @property
    def lamp(self) -> Lamp:
        """The first beacon."""
        return self.lamps[0]


@final
@dataclass(frozen=True, slots=True)
class Illuminance:
    """
    Light on each of a set of small planes.

    Parameters
    ----------
    modulated : ndarray of float64, shape (l, ...)
        Light of each lamp while it is on. [lx]
    steady : ndarray of float64, shape (...)
        Mean ambient light. [lx]
    mains : ndarray of float64, shape (...)
        Amplitude of the mains flicker. [lx]

    """

    modulated: Array
    steady: Array
    mains: Array


def illuminance(field: LightField, points: Array, normals: Array) -> Illuminance:
    """
    Return the light on small planes, part by part.

    Parameters
    ----------
    field : LightField
        The scene.
    points : ndarray of float64, shape (..., 3)
        Where. [m, map]
    normals : ndarray of float64, shape (..., 3)
        Unit normals of the planes. [map]

    """
    modulated = np.stack([direct(lamp, points, normals) for lamp in field.lamps])
    if field.room is not None:
        modulated += np.reshape(
            [field.room.diffuse(lamp.flux) for lamp in field.lamps],
            (len(field.lamps),) + (1,) * (modulated.ndim - 1),
        )
    shape = modulated.shape[1:]
    ambient = field.ambient
    return Illuminance(modulated, np.full(shape, ambient.steady), np.full(shape, ambient.mains))
