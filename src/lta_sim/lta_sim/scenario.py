"""
The scenario file: the world a flight happens in, its start and its goal.

Map frame: origin on the floor at the centre of the room, ENU, z up.
"""

import math
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from lta_config.course import Course
from lta_config.files import checked, find, load_yaml, Record
from lta_config.quantity import Quantity, si
from lta_sim.light_field import Ambient, Lamp, LightField, MOST_EFFICACY, Room
from lta_sim.scenario_air import Air
from lta_vlc.modulation import SquareWave
from pydantic import AliasChoices, Field, model_validator

Point = Annotated[Quantity, si('m', low=-1000.0, high=1000.0, length=3)]
Efficacy = Annotated[Quantity, si('lm/W', above=0.0, high=MOST_EFFICACY)]
Fraction = Annotated[Quantity, si('1', low=0.0, high=1.0)]
NOT_HELD = Quantity(value=0.0, unit='s')


class RoomShape(Record):
    """
    A box around the origin, standing on the floor.

    Light is reflected by its faces. `solid` walls and ceiling hold a hull back; where they are
    `open`, a drone that flies through them has escaped.
    """

    size: Annotated[Quantity, si('m', above=0.0, high=1000.0, length=3)]
    albedo: Annotated[float, Field(ge=0.0, lt=1.0)]
    walls: Literal['solid', 'open'] = 'open'


class LampScene(Record):
    """The beacon."""

    position: Point
    facing: Annotated[Quantity, si('1', length=3)]
    flux: Annotated[Quantity, si('lm', low=0.0, high=1e7)]
    frequency: Annotated[Quantity, si('Hz', above=0.0, high=1e5)]
    duty: Annotated[Quantity, si('1', above=0.0, high=0.999)]
    efficacy: Efficacy


class AmbientScene(Record):
    """All light that is not the beacon's."""

    steady: Annotated[Quantity, si('lx', low=0.0, high=2e5)]
    mains_amplitude: Annotated[Quantity, si('lx', low=0.0, high=2e5)]
    mains_frequency: Annotated[Quantity, si('Hz', above=0.0, high=1e4)]
    efficacy: Efficacy


class Start(Record):
    """Where and how the drone stands before take-off; a hand may hold it there for a while."""

    position: Annotated[Quantity, si('m', low=-1000.0, high=1000.0, length=2)]
    heading: Annotated[Quantity, si('rad')]
    heading_spread: Annotated[Quantity, si('rad', low=0.0, high=math.pi)]
    charge: Fraction
    held: Annotated[Quantity, si('s', low=0.0, high=3600.0)] = NOT_HELD


class Goal(Record):
    """What ends the flight."""

    radius: Annotated[Quantity, si('m', above=0.0)]
    time_limit: Annotated[Quantity, si('s', above=0.0, high=86400.0)]


class Scenario(Record):
    """
    A whole scenario file.

    With a course, that is flown, and nobody looks for the lamp. With a route, its lamps are sought
    one after the other, by name.
    """

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
    about: str
    room: RoomShape
    air: Air
    lamp: LampScene
    ambient: AmbientScene
    start: Start
    goal: Goal
    course: Course | None = None
    route: tuple[str, ...] = ()

    @model_validator(mode='after')
    def _inside(self) -> Self:
        length, width, height = self.room.size.vector
        x, y, z = self.lamp.position.vector
        if abs(x) > length / 2 or abs(y) > width / 2 or not 0 <= z <= height:
            raise ValueError(f'has its lamp at {x, y, z} m, outside the room')
        start_x, start_y = self.start.position.vector
        if abs(start_x) > length / 2 or abs(start_y) > width / 2:
            raise ValueError(f'has its start at {start_x, start_y} m, outside the room')
        if math.hypot(x - start_x, y - start_y) <= self.goal.radius.si:
            raise ValueError('starts within its goal; move the start or make the radius smaller')
        unknown_names = [name for name in self.route if name not in dict(self.beacons)]
        if unknown_names:
            raise ValueError(
                f'has the lamps {", ".join(unknown_names)} on its route, which are not there; '
                f'known: {", ".join(name for name, _ in self.beacons)}'
            )
        if self.route and self.course is not None:
            raise ValueError('has a route and a course; leave one of them out')
        if self.course is not None and self.course.rows[-1].at.si >= self.goal.time_limit.si:
            raise ValueError(
                f'ends after {self.goal.time_limit.si:g} s, before the last row of its course; '
                'give it more time'
            )
        return self

    @property
    def wind_file(self) -> Path | None:
        """The recorded wind; beside the scenario file where that was read by name or path."""
        return None if self.air.recorded is None else Path(self.air.recorded)

    @property
    def beacons(self) -> tuple[tuple[str, float], ...]:
        """Every lamp's name and the frequency at which it flickers. [Hz]"""
        return (('lamp', self.lamp.frequency.si),)

    @property
    def route_beacons(self) -> tuple[tuple[str, float], ...]:
        """The lamps of the route as `beacons`, in order; none without a route."""
        known = dict(self.beacons)
        return tuple((name, known[name]) for name in self.route)

    @property
    def light_field(self) -> LightField:
        """The light of the scene; `BadInput` where the light itself cannot be."""
        lamp, ambient = self.lamp, self.ambient
        return LightField(
            lamp=Lamp(
                position=_three(lamp.position),
                axis=_three(lamp.facing),
                flux=lamp.flux.si,
                wave=SquareWave(lamp.frequency.si, lamp.duty.si),
                efficacy=lamp.efficacy.si,
            ),
            room=Room(_three(self.room.size), self.room.albedo),
            ambient=Ambient(
                efficacy=ambient.efficacy.si,
                steady=ambient.steady.si,
                mains=ambient.mains_amplitude.si,
                mains_frequency=ambient.mains_frequency.si,
            ),
        )


def _three(quantity: Quantity) -> tuple[float, float, float]:
    x, y, z = quantity.vector
    return x, y, z


def load_scenario(name: str) -> Scenario:
    """Return a scenario by shipped name or path; anything wrong is a `BadInput` sentence."""
    path = find('scenario', name)
    return checked(Scenario, beside(load_yaml(path), path.parent), str(path))


def course_in(name: str) -> Course | None:
    """Return the course of a scenario by name or path; None without one, or without a name."""
    return load_scenario(name).course if name else None


def route_in(name: str) -> tuple[tuple[str, float], ...]:
    """Return the route of a scenario by name or path; empty without one, or without a name."""
    return load_scenario(name).route_beacons if name else ()


def beside(content: Any, folder: Path) -> Any:  # noqa: ANN401 - what YAML holds
    """Return what a scenario file holds, its wind file found beside it: by its whole path."""
    try:
        wind_file = content['air']['recorded']
    except (KeyError, TypeError):
        return content
    if not isinstance(wind_file, str):
        return content
    place = str((folder / wind_file).absolute())
    return {**content, 'air': {**content['air'], 'recorded': place}}
