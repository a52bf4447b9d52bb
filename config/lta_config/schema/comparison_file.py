# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The comparison file, and the manoeuvres that platforms are compared by.

A comparison has the platforms, and ablations that explain differences. Each
entry names a vehicle or another entry, and the only differences from it.

A manoeuvre has setpoints over time and the criterion for the score. Altitude is a rise above the
start or release height, so that one manoeuvre fits a micro-drone and a blimp.
"""

from typing import Annotated, Any, final, Literal, NamedTuple, Self

from lta_config.course import Between, check_rising_times, interpolate_rows, Time
from lta_config.files import find_file, load_file, Name, SchemaVersion, StrictModel
from lta_config.quantity import format_quantity, Quantity, si_quantity
from pydantic import AliasChoices, Field, model_validator

# Unit of the tolerance band, by what is judged
BAND_UNITS = {'altitude': 'm', 'heading': 'rad', 'speed': 'm/s'}


class ManeuverRow(StrictModel):
    """Setpoints from one time on."""

    at: Time
    rise: Annotated[Quantity, si_quantity('m', low=0.0, high=1000.0)]
    heading: Annotated[Quantity, si_quantity('rad', low=-100.0, high=100.0)]
    speed: Annotated[Quantity, si_quantity('m/s', low=0.0, high=50.0)]


@final
class ManeuverSetpoint(NamedTuple):
    """Setpoints at one time: rise [m], heading [rad] and speed along it [m/s]."""

    rise: float
    heading: float
    speed: float


class ManeuverFile(StrictModel):
    """A manoeuvre file; `from` and `until` bound the judged time."""

    schema_version: SchemaVersion
    name: Name
    about: str
    judge: Literal['altitude', 'heading', 'speed']
    judged_from: Annotated[Time, Field(validation_alias=AliasChoices('from'))]
    until: Time
    band: Quantity
    between: Between
    course: Annotated[list[ManeuverRow], Field(min_length=1, max_length=1000)]

    @model_validator(mode='after')
    def _check_order(self) -> Self:
        check_rising_times([row.at.si for row in self.course])
        if self.until.si <= self.judged_from.si:
            raise ValueError(
                f'has "from" at {self.judged_from.si:g} s and "until" at {self.until.si:g} s; '
                '"until" must be later'
            )
        unit = BAND_UNITS[self.judge]
        if self.band.si <= 0.0 or self.band.dimension != unit:
            raise ValueError(
                f'has a tolerance band of {format_quantity(self.band)}; give one above 0 in {unit}'
            )
        return self

    def setpoint_at(self, time: float) -> ManeuverSetpoint:
        """Return the setpoint at a time [s]; before the first row, to stay in place."""
        rows = [(row.rise.si, row.heading.si, row.speed.si) for row in self.course]
        # On the ground, with the first heading
        before = (0.0, rows[0][1], 0.0)
        return ManeuverSetpoint(
            *interpolate_rows([row.at.si for row in self.course], rows, self.between, time, before)
        )


def load_maneuver_file(name: str) -> ManeuverFile:
    """Return a manoeuvre by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(ManeuverFile, find_file('manoeuvre', name))


MAX_SPEEDS = 40  # limit for one ladder, each speed being a flight


class EntryChange(StrictModel):
    """The differences of an entry: parameters by path, law and gains."""

    changes: Annotated[
        dict[str, Any], Field(default_factory=dict, validation_alias=AliasChoices('set'))
    ]
    law: str | None = None
    gains: str | None = None


class Contestant(EntryChange):
    """A platform: its vehicle, and its release height if it does not take off."""

    vehicle: str
    title: str
    release: Annotated[Quantity, si_quantity('m', above=0.0, high=100.0)] | None = None


class Ablation(EntryChange):
    """A contestant with one change."""

    of: str


class SpeedSweep(EntryChange):
    """A contestant at increasing speeds."""

    of: str
    manoeuvre: str
    speeds: Quantity


class ComparisonFile(StrictModel):
    """A comparison file."""

    schema_version: SchemaVersion
    name: Name
    about: str
    scenario: str
    contestants: Annotated[dict[Name, Contestant], Field(min_length=1)]
    ablations: dict[Name, Ablation] = Field(default_factory=dict)
    limits: dict[Name, SpeedSweep] = Field(default_factory=dict)

    @model_validator(mode='after')
    def _check_references(self) -> Self:
        for kind, entries in (('ablation', self.ablations), ('limit', self.limits)):
            for name, entry in entries.items():
                if entry.of not in self.contestants:
                    names = ', '.join(self.contestants)
                    raise ValueError(
                        f'has the {kind} {name} with "of: {entry.of}", which is not the name of a '
                        f'contestant; known: {names}'
                    )
        for name, limit in self.limits.items():
            speeds = limit.speeds
            # The set also rejects repeated speeds
            rising = list(speeds.vector) == sorted(set(speeds.vector))
            if speeds.dimension != 'm/s' or not rising or len(speeds.vector) > MAX_SPEEDS:
                raise ValueError(
                    f'has invalid "speeds" in limits.{name}; give at most {MAX_SPEEDS} speeds in '
                    'm/s, in increasing order and without duplicates'
                )
        return self


def load_comparison(name: str) -> ComparisonFile:
    """Return a comparison by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(ComparisonFile, find_file('comparison', name))
