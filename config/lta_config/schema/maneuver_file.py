"""
The manoeuvre file: setpoints over time, and the criterion for the score.

Altitude is a rise above the start or release height, so that one manoeuvre fits a micro-drone and
a sphere of 2.7 m.
"""

from typing import Annotated, final, Literal, NamedTuple, Self

from lta_config.course import Between, check_rising_times, interpolate_rows, Time
from lta_config.files import find_file, load_file, StrictModel
from lta_config.quantity import format_quantity, Quantity, si_quantity
from pydantic import AliasChoices, Field, model_validator

# Unit of the tolerance band, by what is judged
BAND = {'altitude': 'm', 'heading': 'rad', 'speed': 'm/s'}


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
                f'has "from" at {self.judged_from.si:g} s and "until" at {self.until.si:g} s; '
                '"until" must be later'
            )
        unit = BAND[self.judge]
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
