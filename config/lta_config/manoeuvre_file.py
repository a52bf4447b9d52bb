"""
The manoeuvre file: what a platform is asked to do over time, and by what it is judged.

Setpoints are rows over time. Altitude is a rise over where the vehicle stands or was released, so
that one manoeuvre fits a micro-drone and a sphere of 2.7 m.
"""

from bisect import bisect_right
from itertools import pairwise
from typing import Annotated, final, Literal, NamedTuple, Self

from lta_config.files import find, load, Record
from lta_config.quantity import Quantity, si, written
from pydantic import AliasChoices, Field, model_validator

Time = Annotated[Quantity, si('s', low=0.0, high=3600.0)]
BAND = {'altitude': 'm', 'heading': 'rad', 'speed': 'm/s'}


class Row(Record):
    """What is asked for from one time on."""

    at: Time
    rise: Annotated[Quantity, si('m', low=0.0, high=1000.0)]
    heading: Annotated[Quantity, si('rad', low=-100.0, high=100.0)]
    speed: Annotated[Quantity, si('m/s', low=0.0, high=50.0)]


@final
class Asked(NamedTuple):
    """What is asked for at one time: rise [m], heading [rad] and speed along it [m/s]."""

    rise: float
    heading: float
    speed: float


class Manoeuvre(Record):
    """A whole manoeuvre file; `from` and `until` bound what is judged."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
    about: str
    judge: Literal['altitude', 'heading', 'speed']
    judged_from: Annotated[Time, Field(validation_alias=AliasChoices('from'))]
    until: Time
    band: Quantity
    between: Literal['step', 'ramp']
    course: Annotated[list[Row], Field(min_length=1, max_length=1000)]

    @model_validator(mode='after')
    def _in_order(self) -> Self:
        times = [row.at.si for row in self.course]
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise ValueError(f'has rows at {times} s; give them in rising order of time')
        if self.until.si <= self.judged_from.si:
            raise ValueError(
                f'is judged from {self.judged_from.si:g} s until {self.until.si:g} s; let until '
                'be later'
            )
        unit = BAND[self.judge]
        if self.band.si <= 0.0 or self.band.dimension != unit:
            raise ValueError(f'has a band of {written(self.band)}; give one above 0 in {unit}')
        return self

    def asked(self, time: float) -> Asked:
        """Return what is asked for at a time; to stay where it is before the first row. [s]"""
        index = bisect_right([row.at.si for row in self.course], time) - 1
        if index < 0:
            return Asked(0.0, self.course[0].heading.si, 0.0)
        here = self.course[index]
        now = Asked(here.rise.si, here.heading.si, here.speed.si)
        if self.between == 'step' or index + 1 == len(self.course):
            return now
        there = self.course[index + 1]
        part = (time - here.at.si) / (there.at.si - here.at.si)
        goal = (there.rise.si, there.heading.si, there.speed.si)
        return Asked(*(p + part * (q - p) for p, q in zip(now, goal, strict=True)))


def load_manoeuvre(name: str) -> Manoeuvre:
    """Return a manoeuvre by shipped name or path; anything wrong is a `BadInput` sentence."""
    return load(Manoeuvre, find('manoeuvre', name))
