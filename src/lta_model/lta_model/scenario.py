"""
Read scenario files: the world of a flight, its start and its goal.

A scene has one lamp under `lamp`, or several by name under `lamps`; the goal is the first of them,
or all of a route.
Map frame: origin on the floor at the centre of the room, ENU, z up.
"""

from collections.abc import Mapping
import math
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from lta_config.course import Course
from lta_config.files import find_file, load_yaml, StrictModel, validate_content
from lta_config.quantity import Quantity, si_quantity
from lta_model.light.field import LightField
from lta_model.scenario_air import ScenarioAir
from lta_model.scenario_faults import SupplyFaults
from lta_model.scenario_light import (
    AmbientScene,
    DaylightScene,
    LampScene,
    OutsideScene,
    RoomShape,
)
from pydantic import AliasChoices, Field, model_validator

Fraction = Annotated[Quantity, si_quantity('1', low=0.0, high=1.0)]
Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
NOT_HELD = Quantity(value=0.0, unit='s')
# Scenes with one lamp are flown up to 0.5 m below it, and altitude is held to 0.1 m; half a hull
# of 1 m on top makes 1 m. Scenes that are flown higher above their lamps say so.
VERTICAL_TOLERANCE = Quantity(value=1.0, unit='m')


class ScenarioStart(StrictModel):
    """Pose and charge of the drone before take-off; it may be held for a while."""

    position: Annotated[Quantity, si_quantity('m', low=-1000.0, high=1000.0, length=2)]
    heading: Annotated[Quantity, si_quantity('rad')]
    heading_spread: Annotated[Quantity, si_quantity('rad', low=0.0, high=math.pi)]
    charge: Fraction
    held: Annotated[Quantity, si_quantity('s', low=0.0, high=3600.0)] = NOT_HELD


class ScenarioGoal(StrictModel):
    """
    Where and when the flight ends.

    A lamp is reached where the hull centre is within `radius` of it horizontally, and within
    `vertical_tolerance` of its height.
    """

    radius: Annotated[Quantity, si_quantity('m', above=0.0)]
    vertical_tolerance: Annotated[Quantity, si_quantity('m', above=0.0)] = VERTICAL_TOLERANCE
    time_limit: Annotated[Quantity, si_quantity('s', above=0.0, high=86400.0)]


class Scenario(StrictModel):
    """
    A scenario file.

    With a course, the drone flies it instead of searching for the lamp. With a route, it visits
    its lamps in turn, by name.
    """

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
    about: str
    room: RoomShape
    air: ScenarioAir
    alone: Annotated[LampScene | None, Field(validation_alias='lamp')] = None
    several: Annotated[Mapping[Name, LampScene], Field(validation_alias='lamps')] = Field(
        default_factory=dict
    )
    ambient: AmbientScene
    daylight: DaylightScene | None = None
    outside: OutsideScene | None = None
    start: ScenarioStart
    goal: ScenarioGoal
    faults: SupplyFaults = SupplyFaults()
    course: Course | None = None
    route: Annotated[tuple[str, ...], Field(strict=False)] = ()  # a list in the file

    @model_validator(mode='after')
    def _check_lamps(self) -> Self:
        if (self.alone is None) == (not self.several):
            raise ValueError(
                'needs either one lamp under "lamp", or several named lamps under "lamps"'
            )
        return self

    @model_validator(mode='after')
    def _check_places(self) -> Self:
        length, width, height = self.room.size.vector
        for name, lamp in self.lamps.items():
            x, y, z = lamp.position.vector
            # The origin of the map is the middle of the floor
            indoors = abs(x) <= length / 2 and abs(y) <= width / 2 and 0 <= z <= height
            if not (indoors or self._is_beyond_door(x, y, z)):
                raise ValueError(
                    f'has its {name} at {x, y, z} m, outside the room; move it into the room'
                )
        unknown_names = [name for name in self.route if name not in self.lamps]
        if unknown_names:
            raise ValueError(
                f'names unknown lamps in its route: {", ".join(unknown_names)}; its lamps '
                f'are {", ".join(self.lamps)}'
            )
        x, y, _ = self.target_lamps[0].position.vector
        start_x, start_y = self.start.position.vector
        if abs(start_x) > length / 2 or abs(start_y) > width / 2:
            raise ValueError(
                f'has its start at {start_x, start_y} m, outside the room; move start.position '
                'into the room'
            )
        if math.hypot(x - start_x, y - start_y) <= self.goal.radius.si:
            raise ValueError(
                'starts within its goal; move the start away from the lamp, or make '
                'goal.radius smaller'
            )
        if self.route and self.course is not None:
            raise ValueError('has both a route and a course; remove one of them')
        if self.course is not None and self.course.rows[-1].at.si >= self.goal.time_limit.si:
            raise ValueError(
                f'ends after {self.goal.time_limit.si:g} s, before the last row of its '
                'course; increase goal.time_limit'
            )
        return self

    @model_validator(mode='after')
    def _check_door(self) -> Self:
        if self.outside is not None and self.room.walls == 'solid':
            raise ValueError(
                'has a door ("outside"), but its walls are solid, so no drone can leave; '
                'set room.walls to open. A drone that then leaves except through the door '
                'counts as escaped'
            )
        return self

    def _is_beyond_door(self, x: float, y: float, z: float) -> bool:
        """Return whether a place is out of the door and within reach. [m]"""
        if self.outside is None:
            return False
        reach, wall = self.outside.reach.si, self.room.size.vector[0] / 2
        return wall < x <= wall + reach and abs(y) <= reach and 0.0 <= z <= reach

    @property
    def wind_file(self) -> Path | None:
        """The recorded wind; beside the scenario file where that was read by name or path."""
        return None if self.air.recorded is None else Path(self.air.recorded)

    @property
    def lamps(self) -> Mapping[str, LampScene]:
        """All lamps by name; one alone is called `lamp`."""
        return self.several if self.alone is None else {'lamp': self.alone}

    @property
    def goal_lamp(self) -> LampScene:
        """The lamp that is the goal: the last of the route, or else the first there is."""
        return self.target_lamps[-1]

    @property
    def target_lamps(self) -> tuple[LampScene, ...]:
        """The lamps to reach, in order."""
        names = self.route or tuple(self.lamps)[:1]
        return tuple(self.lamps[name] for name in names)

    @property
    def goal_places(self) -> tuple[tuple[float, float], ...]:
        """Where the lamps to reach stand on the floor plan, each once. [m, map]"""
        places = (stop.position.vector for stop in self.target_lamps)
        # dict.fromkeys removes duplicates and keeps the order
        return tuple(dict.fromkeys((x, y) for x, y, _ in places))

    @property
    def beacons(self) -> tuple[tuple[str, float], ...]:
        """Name and nominal frequency of each lamp. [Hz]"""
        return tuple((name, lamp.frequency.si) for name, lamp in self.lamps.items())

    @property
    def route_beacons(self) -> tuple[tuple[str, float], ...]:
        """The lamps of the route as `beacons`, in order; none without a route."""
        beacons = dict(self.beacons)
        return tuple((name, beacons[name]) for name in self.route)

    @property
    def sun(self) -> DaylightScene | None:
        """The daylight of the scene, or of the place outside its door."""
        return self.daylight if self.outside is None else self.outside.daylight

    @property
    def light_field(self) -> LightField:
        """The light of the scene; `BadInput` where the light itself cannot be."""
        return LightField(
            tuple(lamp.lamp for lamp in self.lamps.values()),
            self.ambient.ambient,
            self.room.room,
            None
            if self.daylight is None
            else self.daylight.build_daylight(self.room.albedo.floor),
            None if self.outside is None else self.outside.outdoor_area,
        )


def load_scenario(name: str) -> Scenario:
    """Load a scenario by shipped name or path; raise `BadInput` if anything is wrong."""
    path = find_file('scenario', name)
    return validate_content(Scenario, resolve_wind_file(load_yaml(path), path.parent), str(path))


def load_course(name: str) -> Course | None:
    """Return the course of a scenario by name or path; None without a course or name."""
    return load_scenario(name).course if name else None


def load_route(name: str) -> tuple[tuple[str, float], ...]:
    """Return the route of a scenario as lamp and frequency [Hz]; empty without one or a name."""
    return load_scenario(name).route_beacons if name else ()


def resolve_wind_file(content: Any, folder: Path) -> Any:  # noqa: ANN401 - what YAML holds
    """Return the content of a scenario file with the full path of its wind file."""
    try:
        wind_file = content['air']['recorded']
    except (KeyError, TypeError):
        return content
    if not isinstance(wind_file, str):
        return content
    place = str((folder / wind_file).absolute())
    return {**content, 'air': {**content['air'], 'recorded': place}}
