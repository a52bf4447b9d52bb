# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
r"""
All light of a scene, in the map frame.

On each small plane falls

- the direct light of each lamp by the inverse square, and its reflections from a room
  (`reflected_light`, `Room`): modulated;
- ambient light from all sides: a steady part and the flicker of mains lamps at twice the mains
  frequency and its multiples (`Ambient`);
- sun and sky (`Daylight`), over the whole scene or beyond a door (`OutdoorArea`).

The sky is uniformly bright, the ground reflects its albedo, and the sun is a small disc. The sun
gives up to some 100 klx on a facing plane, a clear sky 10 to 20 klx on level ground (from memory).

Of a flux :math:`\Phi` that falls on the surfaces of a room the mean albedo :math:`\varrho` goes on
each time; if that is the same everywhere and from all sides (Sumpner, Phil. Mag. 35, 1893), on a
plane anywhere lie

.. math:: E = \frac{\Phi}{A} \sum_{k \ge 1} \varrho^k = \frac{\Phi \varrho}{A (1 - \varrho)}

Lux over the luminous efficacy of the light (white LED 326 lm/W, sun 109) is irradiance.
"""

from dataclasses import dataclass
import math
from typing import final, NamedTuple

from lta_model.light.lamp import BeaconLamp, require, require_efficacy, require_lux
import numpy as np
from numpy.typing import NDArray


@final
@dataclass(frozen=True, slots=True)
class Ambient:
    """Ambient light, the same from all sides."""

    efficacy: float  # luminous by radiant flux, of the steady part and the flicker alike [lm/W]
    steady: float = 0.0  # mean illuminance [lx]
    mains: float = 0.0  # amplitude of the mains flicker; with its harmonics at most `steady` [lx]
    # Frequency of that flicker, twice that of the mains [Hz], and its phase at time zero [cycles]
    mains_frequency: float = 100.0
    mains_phase: float = 0.0
    # Amplitudes at two, three, ... times that frequency relative to `mains`, in phase with it
    mains_harmonics: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Refuse negative or infinite light."""
        require_efficacy(self.efficacy)
        require_lux('The ambient light', self.steady)
        require(
            all(0.0 <= part <= 1.0 for part in self.mains_harmonics),
            f'The harmonics of the mains flicker are {self.mains_harmonics}; each must be '
            'from 0 to 1, relative to the fundamental.',
        )
        require(
            # The sum must not become negative at any time of the flicker
            0.0 <= self.mains <= self.steady / (1.0 + sum(self.mains_harmonics)),
            f'The mains flicker has an amplitude of {self.mains} lx around a mean of '
            f'{self.steady} lx; the amplitude, including harmonics, must be from 0 to the '
            'mean.',
        )
        require(
            math.isfinite(self.mains_frequency) and self.mains_frequency > 0.0,
            f'The mains flicker has a frequency of {self.mains_frequency} Hz; the frequency '
            'must be positive.',
        )
        require(
            math.isfinite(self.mains_phase),
            f'The mains flicker has a phase of {self.mains_phase} cycles; the phase must be '
            'finite.',
        )


Vector = tuple[float, float, float]


@final
@dataclass(frozen=True, slots=True)
class Daylight:
    """
    Sun and sky.

    Parameters
    ----------
    sun, sky : float
        Illuminance by the sun on a facing plane, and by the sky on level ground. [lx]
    azimuth, elevation : float
        Of the sun: from map x towards y, and above the horizon. [rad]
    ground : float
        Albedo of the ground, 0 to below 1.
    efficacy : float
        Luminous by radiant flux. [lm/W]

    """

    sun: float
    azimuth: float
    elevation: float
    sky: float
    ground: float
    efficacy: float

    def __post_init__(self) -> None:
        """Refuse impossible daylight."""
        require_lux('The illuminance by the sun', self.sun)
        require_lux('The illuminance by the sky', self.sky)
        require_efficacy(self.efficacy)
        require(
            math.isfinite(self.azimuth) and 0.0 < self.elevation <= math.pi / 2.0,
            f'The sun is {math.degrees(self.elevation):g} degrees above the horizon; its '
            'elevation must be above 0 and at most 90 degrees.',
        )
        require(
            0.0 <= self.ground < 1.0,
            f'The ground has an albedo of {self.ground}; the albedo must be at least 0 and '
            'below 1.',
        )

    @property
    def sun_direction(self) -> Vector:
        """Return the unit vector to the sun [map]."""
        # Horizontal component of the unit vector
        level = math.cos(self.elevation)
        return (
            level * math.cos(self.azimuth),
            level * math.sin(self.azimuth),
            math.sin(self.elevation),
        )

    @property
    def ground_illuminance(self) -> float:
        """Illuminance of level ground [lx]."""
        # Lambert's cosine law on level ground
        return self.sun * math.sin(self.elevation) + self.sky


@final
@dataclass(frozen=True, slots=True)
class OutdoorArea:
    """The open beyond a door in the wall at the high end of map x, down to the floor."""

    daylight: Daylight  # light outdoors
    middle: float  # middle of the door along map y [m]
    # Of the door [m]
    width: float
    height: float

    def __post_init__(self) -> None:
        """Refuse an impossible door."""
        require(
            math.isfinite(self.middle) and self.width > 0.0 and self.height > 0.0,
            f'The door is {self.width} m wide and {self.height} m high; make both positive.',
        )


class Albedo(NamedTuple):
    """Reflected share of the light on floor, walls and ceiling, each 0 to below 1."""

    floor: float
    walls: float
    ceiling: float


@final
@dataclass(frozen=True, slots=True)
class Room:
    """A box on the floor around the map's origin: length, width and height [m], and albedo."""

    size: Vector
    albedo: Albedo

    def __post_init__(self) -> None:
        """Refuse an impossible room."""
        require(
            all(math.isfinite(side) and side > 0.0 for side in self.size),
            f'The room measures {self.size} m; make every side positive.',
        )
        for name, albedo in self.albedo._asdict().items():
            require(
                0.0 <= albedo < 1.0,
                f'The {name} of the room has an albedo of {albedo}; the albedo must be at least '
                '0 and below 1.',
            )

    @property
    def surface_area(self) -> float:
        """Of all surfaces [m2]."""
        length, width, height = self.size
        return 2.0 * (length * width + length * height + width * height)

    @property
    def mean_albedo(self) -> float:
        """Albedo of all surfaces, each by its area."""
        length, width, height = self.size
        flat, upright = length * width, 2.0 * height * (length + width)
        floor, walls, ceiling = self.albedo
        return (flat * (floor + ceiling) + upright * walls) / self.surface_area


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
        """Return the first beacon."""
        return self.lamps[0]

    @property
    def any_daylight(self) -> Daylight | None:
        """Return the daylight of the scene, or that beyond its door."""
        return self.daylight if self.outside is None else self.outside.daylight


@final
@dataclass(frozen=True, slots=True)
class PlaneIlluminance:
    """Light on each of a set of small planes."""

    modulated: Array  # light of each lamp while it is on, shape (l, ...) [lx]
    steady: Array  # mean ambient light, shape (...) [lx]
    mains: Array  # amplitude of the mains flicker, shape (...) [lx]
