"""
All light of a scene, in the map frame.

On each small plane falls

- the direct light of each lamp by the inverse square, and its reflections from a room
  (`ray_integration`, `room`): modulated;
- ambient light from all sides: a steady part and mains flicker (`ambient`);
- sun and sky (`daylight`), over the whole scene or beyond a door (`outside`).

Lux over the luminous efficacy of the light (white LED 300 lm/W, sun 105) is irradiance.
"""

from dataclasses import dataclass
from typing import final

from lta_model.light.ambient import Ambient
from lta_model.light.daylight import Daylight
from lta_model.light.lamp import BeaconLamp
from lta_model.light.light_checks import require
from lta_model.light.outdoors import OutdoorArea
from lta_model.light.room import Room
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class LightField:
    """All light of a scene."""

    lamps: tuple[BeaconLamp, ...]  # the beacons, at least one
    ambient: Ambient  # light from all sides; in the room only, where there is an outside
    room: Room | None = None  # reflecting surfaces around the lamps
    daylight: Daylight | None = None  # over the whole scene
    outside: OutdoorArea | None = None  # the area beyond a door of the room

    def __post_init__(self) -> None:
        """Refuse a scene without a lamp, and a door that does not fit."""
        require(len(self.lamps) > 0, 'The scene has no lamp; add at least one.')
        door = self.outside
        if door is None:
            return
        require(self.room is not None, 'The scene has a door but no room; add a room.')
        require(
            self.daylight is None,
            'The scene has daylight both in the room ("daylight") and beyond its door '
            '("outside"); remove "daylight".',
        )
        _, width, height = self.room.size if self.room is not None else (0.0, 0.0, 0.0)
        require(
            # The whole door must lie in the wall at the high end of x
            abs(door.middle) + 0.5 * door.width <= 0.5 * width and door.height <= height,
            f'The door of {door.width:g} by {door.height:g} m at y = {door.middle:g} m does not '
            f'fit into a wall of {width:g} by {height:g} m; move it or make it smaller.',
        )

    @property
    def first_lamp(self) -> BeaconLamp:
        """The first beacon."""
        return self.lamps[0]

    @property
    def any_daylight(self) -> Daylight | None:
        """The daylight of the scene, or that beyond its door."""
        return self.daylight if self.outside is None else self.outside.daylight


@final
@dataclass(frozen=True, slots=True)
class PlaneIlluminance:
    """Light on each of a set of small planes."""

    modulated: Array  # light of each lamp while it is on, shape (l, ...) [lx]
    steady: Array  # mean ambient light, shape (...) [lx]
    mains: Array  # amplitude of the mains flicker, shape (...) [lx]
