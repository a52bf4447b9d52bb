# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The light section of a scenario file: room, lamps and ambient light.

Omitted entries mean an ideal lamp: no clock error, no harmonics, no rise time.
"""

import math
from typing import Annotated, Any, Literal

from lta_config.files import StrictModel
from lta_config.quantity import describe_misfit, Quantity, si_quantity
from lta_config.schema.spectrum_file import Efficacy
from lta_model.light.field import Albedo, Ambient, Daylight, OutdoorArea, Room
from lta_model.light.lamp import (
    BeaconLamp,
    DriftingClock,
    lambertian_order,
    MAX_CLOCK_OFFSET,
    SquareWave,
)
from pydantic import AfterValidator, BeforeValidator, Field

Point = Annotated[Quantity, si_quantity('m', low=-1000.0, high=1000.0, length=3)]
Share = Annotated[float, Field(ge=0.0, lt=1.0)]
NO_SHARE = Quantity(value=0.0, unit='1')
DEFAULT_SLACK = Quantity(value=0.5, unit='1')
HALF_POWER_ANGLE = Quantity(value=60.0, unit='deg')
LAMP_RADIUS = Quantity(value=15.0, unit='mm')


class Surfaces(StrictModel):
    """Albedo of each kind of surface."""

    floor: Share
    walls: Share
    ceiling: Share


def _expand_albedo(value: Any) -> Any:
    """Return one albedo for all surfaces as that of each."""
    # bool is an int in Python
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    if not 0.0 <= value < 1.0:
        bound = 'below 1' if value >= 1.0 else 'at least 0'
        raise ValueError(f'is {value!r}, but must be {bound}')
    return dict.fromkeys(Surfaces.model_fields, float(value))


class RoomShape(StrictModel):
    """
    A box around the origin, standing on the floor.

    Light is reflected by its faces. `solid` walls and ceiling hold a hull back; where they are
    `open`, a drone that flies through them has escaped.
    """

    size: Annotated[Quantity, si_quantity('m', above=0.0, high=1000.0, length=3)]
    albedo: Annotated[Surfaces, BeforeValidator(_expand_albedo)]
    walls: Literal['solid', 'open'] = 'open'

    @property
    def room(self) -> Room:
        """Return the room as reflecting surfaces."""
        floor, walls, ceiling = self.albedo.floor, self.albedo.walls, self.albedo.ceiling
        return Room(to_triple(self.size), Albedo(floor, walls, ceiling))


class LampScene(StrictModel):
    """A beacon."""

    position: Point
    facing: Annotated[Quantity, si_quantity('1', length=3)]
    flux: Annotated[Quantity, si_quantity('lm', low=0.0, high=1e7)]
    frequency: Annotated[Quantity, si_quantity('Hz', above=0.0, high=1e5)]
    duty: Annotated[Quantity, si_quantity('1', above=0.0, high=0.999)]
    efficacy: Efficacy
    half_power: Annotated[Quantity, si_quantity('rad', low=0.05, high=1.55)] = HALF_POWER_ANGLE
    radius: Annotated[Quantity, si_quantity('m', above=0.0, high=10.0)] = LAMP_RADIUS
    rise: Annotated[Quantity, si_quantity('s', low=0.0, high=1.0)] = Quantity(value=0.0, unit='s')
    clock_error: Annotated[
        Quantity, si_quantity('1', low=-MAX_CLOCK_OFFSET, high=MAX_CLOCK_OFFSET)
    ] = NO_SHARE
    clock_drift: Annotated[Quantity, si_quantity('1/s', low=-1e-3, high=1e-3)] = Quantity(
        value=0.0, unit='1/s'
    )

    @property
    def lamp(self) -> BeaconLamp:
        """Return the lamp; `BadInput` if it is impossible."""
        return BeaconLamp(
            position=to_triple(self.position),
            axis=to_triple(self.facing),
            flux=self.flux.si,
            wave=SquareWave(self.frequency.si, self.duty.si),
            efficacy=self.efficacy.si,
            order=lambertian_order(self.half_power.si),
            radius=self.radius.si,
            rise=self.rise.si,
            clock=DriftingClock(self.clock_error.si, self.clock_drift.si),
        )


def _check_shares(quantity: Quantity) -> Quantity:
    """Return a quantity of any number of shares from 0 to 1, or refuse it."""
    if complaint := describe_misfit(quantity, '1', 0.0, 1.0, length=len(quantity.vector)):
        raise ValueError(complaint)
    return quantity


class AmbientScene(StrictModel):
    """All light that is not a beacon's."""

    steady: Annotated[Quantity, si_quantity('lx', low=0.0, high=2e5)]
    mains_amplitude: Annotated[Quantity, si_quantity('lx', low=0.0, high=2e5)]
    mains_frequency: Annotated[Quantity, si_quantity('Hz', above=0.0, high=1e4)]
    mains_harmonics: Annotated[Quantity, AfterValidator(_check_shares)] = Quantity(
        value=(), unit='1'
    )
    efficacy: Efficacy

    @property
    def ambient(self) -> Ambient:
        """Return the light; `BadInput` if it is impossible."""
        return Ambient(
            efficacy=self.efficacy.si,
            steady=self.steady.si,
            mains=self.mains_amplitude.si,
            mains_frequency=self.mains_frequency.si,
            mains_harmonics=self.mains_harmonics.vector,
        )


class DaylightScene(StrictModel):
    """
    Sun and sky; the sun on a plane that faces it, the sky on level ground.

    They warm the gas of the hull (effect `superheat`), whose envelope lets it expand by `slack`:
    0 is a taut hull, whose lift stays, 1 a slack one. Nothing is known of foil balloons.
    """

    sun: Annotated[Quantity, si_quantity('lx', low=0.0, high=2e5)]
    azimuth: Annotated[Quantity, si_quantity('rad')]
    elevation: Annotated[Quantity, si_quantity('rad', above=0.0, high=math.pi / 2.0)]
    sky: Annotated[Quantity, si_quantity('lx', low=0.0, high=2e5)]
    efficacy: Efficacy
    slack: Annotated[Quantity, si_quantity('1', low=0.0, high=1.0)] = DEFAULT_SLACK

    def build_daylight(self, ground: float) -> Daylight:
        """Return the light over ground of some albedo [1]."""
        return Daylight(
            self.sun.si, self.azimuth.si, self.elevation.si, self.sky.si, ground, self.efficacy.si
        )


class DoorScene(StrictModel):
    """An opening in the wall at the high end of map x, from the floor up."""

    middle: Annotated[Quantity, si_quantity('m', low=-1000.0, high=1000.0)]  # along map y
    width: Annotated[Quantity, si_quantity('m', above=0.0, high=1000.0)]
    height: Annotated[Quantity, si_quantity('m', above=0.0, high=1000.0)]


class OutsideScene(StrictModel):
    """
    The area beyond a door: its light, its wind, and the flight's limit from the wall.

    A drone that leaves the room beside the door has escaped.
    """

    door: DoorScene
    reach: Annotated[Quantity, si_quantity('m', above=0.0, high=1000.0)]
    daylight: DaylightScene
    ground: Share
    wind: Annotated[Quantity, si_quantity('m/s', low=-50.0, high=50.0, length=3)]

    @property
    def outdoor_area(self) -> OutdoorArea:
        """Return the light outdoors; `BadInput` if it is impossible."""
        door = self.door
        daylight = self.daylight.build_daylight(self.ground)
        return OutdoorArea(daylight, door.middle.si, door.width.si, door.height.si)


def to_triple(quantity: Quantity) -> tuple[float, float, float]:
    """Return the numbers of a quantity that has three [SI]."""
    x, y, z = quantity.vector
    return x, y, z
