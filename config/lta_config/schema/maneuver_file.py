"""
The manoeuvre file: what a platform is asked to do over time, and by what it is judged.

Setpoints are rows over time. Altitude is a rise over where the vehicle stands or was released, so
that one manoeuvre fits a micro-drone and a sphere of 2.7 m.
"""

from typing import Annotated, final, Literal, NamedTuple, Self

from lta_config.course import Between, check_rising_times, interpolate_rows, Time
from lta_config.files import find_file, load_file, StrictModel
from lta_config.quantity import format_quantity, Quantity, si_quantity
from pydantic import AliasChoices, Field, model_validator

BAND = {'altitude': 'm', 'heading': 'rad', 'speed': 'm/s'}


class ManeuverRow(StrictModel):
    """What is asked for from one time on."""

    at: Time
    rise: Annotated[Quantity, si_quantity('m', low=0.0, high=1000.0)]
    heading: Annotated[Quantity, si_quantity('rad', low=-100.0, high=100.0)]
    speed: Annotated[Quantity, si_quantity('m/s', low=0.0, high=50.0)]


@final
class ManeuverSetpoint(NamedTuple):
    """What is asked for at one time: rise [m], heading [rad] and speed along it [m/s]."""

    rise: float
    heading: float
    speed: float


class ManeuverFile(StrictModel):
    """A whole manoeuvre file; `from` and `until` bound what is judged."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
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
                f'is judged from {self.judged_from.si:g} s until {self.until.si:g} s; let until '
                'be later'
            )
        unit = BAND[self.judge]
        if self.band.si <= 0.0 or self.band.dimension != unit:
            raise ValueError(
                f'has a band of {format_quantity(self.band)}; give one above 0 in {unit}'
            )
        return self

    def setpoint_at(self, time: float) -> ManeuverSetpoint:
        """Return what is asked for at a time; to stay where it is before the first row. [s]"""
        rows = [(row.rise.si, row.heading.si, row.speed.si) for row in self.course]
        before = (0.0, rows[0][1], 0.0)
        return ManeuverSetpoint(
            *interpolate_rows([row.at.si for row in self.course], rows, self.between, time, before)
        )


def load_maneuver(name: str) -> ManeuverFile:
    """Return a manoeuvre by shipped name or path; anything wrong is a `BadInput` sentence."""
    return load_file(ManeuverFile, find_file('manoeuvre', name))
