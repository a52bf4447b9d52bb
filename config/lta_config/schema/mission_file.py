# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The mission file: vehicle, route of beacons, payload and reserve of a patrol, and its light.

The light of a day on the perch is a file of its own: sun through glass with clouds, and lamps with
timers. Times are local solar time from midnight. The illuminance of a lamp is that on the panel of
the perched drone; for a beacon it is that during an on phase.
"""

from collections.abc import Mapping
import math
from typing import Annotated, Self

from lta_config.files import find_file, load_file, Name, SchemaVersion, StrictModel
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.spectrum_file import Efficacy
from pydantic import Field, model_validator

DAY = 86400.0  # s
Share = Annotated[Quantity, si_quantity('1', low=0.0, high=1.0, sourced=True)]
Shares = Annotated[Quantity, si_quantity('1', low=0.0, high=1.0, length=2, sourced=True)]
Lux = Annotated[Quantity, si_quantity('lx', low=0.0, high=2e5, sourced=True)]
STEADY_LIGHT = Quantity(value=1.0, unit='1', source='not flickering')


class CloudSequence(StrictModel):
    """
    A sequence of passing clouds.

    `cover` bounds the clouded share of a day, uniform per day. `through` bounds the transmission
    of a cloud, uniform per cloud. `length` is the mean duration of a shadow, exponentially
    distributed.
    """

    cover: Shares
    through: Shares
    length: Annotated[Quantity, si_quantity('s', above=0.0, high=DAY, sourced=True)]

    @model_validator(mode='after')
    def _check_rising(self) -> Self:
        for name in ('cover', 'through'):
            low, high = getattr(self, name).vector
            if low > high:
                raise ValueError(
                    f'has a lower bound of "{name}" that is above its upper bound; swap the two '
                    'numbers'
                )
        return self


class SunModel(StrictModel):
    """Sun and sky on the horizontal panel: a clear day by latitude and date, glass, clouds."""

    latitude: Annotated[
        Quantity, si_quantity('rad', low=-math.pi / 2, high=math.pi / 2, sourced=True)
    ]
    day: Annotated[int, Field(ge=1, le=366)]
    through: Share
    efficacy: Efficacy
    clouds: CloudSequence


class TimedLamp(StrictModel):
    """A lamp over the perch, on between two times of day; past midnight if the first is later."""

    light: Lux
    efficacy: Efficacy
    duty: Share = STEADY_LIGHT
    hours: Annotated[Quantity, si_quantity('s', low=0.0, high=DAY, length=2, sourced=True)]


class LightDay(StrictModel):
    """A file with the light of a day."""

    schema_version: SchemaVersion
    name: Name
    about: str
    sun: SunModel | None = None
    lamps: Mapping[Name, TimedLamp] = {}

    @model_validator(mode='after')
    def _check_light(self) -> Self:
        if self.sun is None and not self.lamps:
            raise ValueError(
                'has neither "sun" nor "lamps", so the battery would never charge; add one of them'
            )
        flickering = [name for name, lamp in self.lamps.items() if lamp.duty.si < 1.0]
        if len(flickering) > 1:
            raise ValueError(
                f'has several flickering lamps ({", ".join(flickering)}: "duty" is below 1), but '
                'only one is supported; set "duty" to 1 for the others'
            )
        return self


def load_light_day(name: str) -> LightDay:
    """Return the light of a day by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(LightDay, find_file('light of the day', name))


Power = Annotated[Quantity, si_quantity('W', low=0.0, high=100.0, sourced=True)]
Time = Annotated[Quantity, si_quantity('s', low=0.0, high=DAY, sourced=True)]
Beacon = Name


class InspectionPayload(StrictModel):
    """An inspection sensor below the hull, switched on while the drone dwells at a beacon."""

    mass: Annotated[Quantity, si_quantity('kg', low=0.0, high=1.0, sourced=True)]
    sensing: Power
    radio: Power


class DutyCycle(StrictModel):
    """The naive schedule: rest for a multiple of the duration of the last flight."""

    rest: Annotated[float, Field(gt=0.0, le=1000.0)]
    source: str


class MissionFile(StrictModel):
    """A mission file."""

    schema_version: SchemaVersion
    name: Name
    about: str
    vehicle: str
    scene: str
    light: str
    altitude: Annotated[Quantity, si_quantity('m', above=0.0, high=100.0)]
    perch: Beacon
    round: Annotated[tuple[Beacon, ...], Field(strict=False, min_length=1, max_length=50)]
    dwell: Annotated[Quantity, si_quantity('s', low=0.0, high=3600.0)]
    payload: InspectionPayload | None = None
    # Of the photodiodes' amplifiers, mounted for the light of the place; else the vehicle's own
    feedback: Annotated[Quantity, si_quantity('ohm', above=0.0, sourced=True)] | None = None
    # Start and end of the working hours, as time of day
    work: Annotated[Quantity, si_quantity('s', low=0.0, high=DAY, length=2, sourced=True)]
    asleep: Power
    reserve: Share  # state of charge to keep for the way back
    dock: Annotated[Quantity, si_quantity('m', above=0.0, high=10.0, sourced=True)]
    fetched: Time  # after which people bring a stranded drone back
    charge: Share  # state of charge at the start, at midnight
    duty: DutyCycle

    @model_validator(mode='after')
    def _check_round(self) -> Self:
        # The drone returns to the perch after every round anyway
        if self.perch in self.round:
            raise ValueError(
                f'has the perch {self.perch} in its "round"; remove it, because every round ends '
                'at the perch anyway'
            )
        return self


def load_mission(name: str) -> MissionFile:
    """Return a mission file by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(MissionFile, find_file('mission', name))
