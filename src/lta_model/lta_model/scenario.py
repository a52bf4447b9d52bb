# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read scenario files: the world of a flight, its start and its goal.

A scene has one lamp under `lamp`, or several by name under `lamps`; the goal is the first of them,
or all of a route.
Map frame: origin on the floor at the centre of the room, ENU, z up.
"""

from collections.abc import Mapping
import math
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Self

from lta_config.course import Course
from lta_config.errors import BadInput
from lta_config.files import (
    find_file,
    load_yaml,
    Name,
    SchemaVersion,
    StrictModel,
    validate_content,
)
from lta_config.quantity import Quantity, si_quantity
from lta_model.light.field import LightField
from lta_model.scenario_air import ScenarioAir
from lta_model.scenario_light import (
    AmbientScene,
    DaylightScene,
    LampScene,
    OutsideScene,
    RoomShape,
    to_triple,
)
from pydantic import Field, model_validator, ValidationError

When = Annotated[Quantity, si_quantity('s', low=0.0, high=86400.0)]


class FaultTimes(NamedTuple):
    """`SupplyFaults` as numbers, for compiled code: times after the start, inf for never [s]."""

    panel_short: float
    brown_out: float


class SupplyFaults(StrictModel):
    """
    Faults of the supply, each from a time after the start on.

    `panel_short`: the array is shorted and gives current without voltage. `brown_out`: the supply
    fails once, and recovers when light has charged the cell a little.
    """

    panel_short: When | None = None
    brown_out: When | None = None

    @property
    def times(self) -> FaultTimes:
        """Return the times of the faults."""
        return FaultTimes(
            math.inf if self.panel_short is None else self.panel_short.si,
            math.inf if self.brown_out is None else self.brown_out.si,
        )


def is_shorted(faults: FaultTimes, elapsed: float) -> bool:
    """Return whether the array is shorted at a time after the start [s]."""
    return elapsed >= faults.panel_short


def is_cut_off(faults: FaultTimes, before: float, elapsed: float) -> bool:
    """Return whether the supply is cut off between two times after the start [s]."""
    return before <= faults.brown_out < elapsed


Fraction = Annotated[Quantity, si_quantity('1', low=0.0, high=1.0)]
NO_HOLD = Quantity(value=0.0, unit='s')
# Scenes with one lamp are flown up to 0.5 m below it, and altitude is held to 0.1 m; half a hull
# of 1 m on top makes 1 m. Scenes that are flown higher above their lamps say so.
VERTICAL_TOLERANCE = Quantity(value=1.0, unit='m')
STAY = Quantity(value=3.0, unit='s')  # a drone that only passes a lamp has left by then
STAYING = ('homing',)  # strategies of LTA that notice their arrival


class ScenarioStart(StrictModel):
    """Pose and charge of the drone before take-off; it may be held for a while."""

    position: Annotated[Quantity, si_quantity('m', low=-1000.0, high=1000.0, length=2)]
    heading: Annotated[Quantity, si_quantity('rad')]
    heading_spread: Annotated[Quantity, si_quantity('rad', low=0.0, high=math.pi)]
    charge: Fraction
    held: Annotated[Quantity, si_quantity('s', low=0.0, high=3600.0)] = NO_HOLD


class ScenarioGoal(StrictModel):
    """
    Where and when the flight ends.

    A lamp is reached where the hull centre is within `radius` of it horizontally, and within
    `vertical_tolerance` of its height. At the last one, a drone that flies by a strategy of
    `STAYING` must stay there for `stay`. The others never notice their arrival, and fly on: as in
    the paper, a lamp that they pass is reached.
    """

    radius: Annotated[Quantity, si_quantity('m', above=0.0)]
    vertical_tolerance: Annotated[Quantity, si_quantity('m', above=0.0)] = VERTICAL_TOLERANCE
    time_limit: Annotated[Quantity, si_quantity('s', above=0.0, high=86400.0)]
    stay: Annotated[Quantity, si_quantity('s', low=0.0, high=3600.0)] = STAY

    def find_stay(self, strategy: str) -> float:
        """Return how long a drone that flies by a strategy must stay at the last lamp [s]."""
        return self.stay.si if strategy in STAYING else 0.0


class Scenario(StrictModel):
    """
    A scenario file.

    With a course, the drone flies it instead of searching for the lamp. With a route, it visits
    its lamps in turn, by name.
    """

    schema_version: SchemaVersion
    name: Name
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
        """Return whether a place is out of the door and within reach [m]."""
        if self.outside is None:
            return False
        reach, wall = self.outside.reach.si, self.room.size.vector[0] / 2
        return wall < x <= wall + reach and abs(y) <= reach and 0.0 <= z <= reach

    @property
    def wind_file(self) -> Path | None:
        """Return the recorded wind, from beside a scenario file that was read by name or path."""
        return None if self.air.recorded is None else Path(self.air.recorded)

    @property
    def lamps(self) -> Mapping[str, LampScene]:
        """All lamps by name; one alone is called `lamp`."""
        return self.several if self.alone is None else {'lamp': self.alone}

    @property
    def goal_lamp(self) -> LampScene:
        """Return the lamp that is the goal: the last of the route, or else the first there is."""
        return self.target_lamps[-1]

    @property
    def target_lamps(self) -> tuple[LampScene, ...]:
        """Return the lamps to reach, in order."""
        names = self.route or tuple(self.lamps)[:1]
        return tuple(self.lamps[name] for name in names)

    @property
    def goal_places(self) -> tuple[tuple[float, float], ...]:
        """Where the lamps to reach stand on the floor plan, each once [m, map]."""
        places = (stop.position.vector for stop in self.target_lamps)
        # dict.fromkeys removes duplicates and keeps the order
        return tuple(dict.fromkeys((x, y) for x, y, _ in places))

    @property
    def beacons(self) -> tuple[tuple[str, float], ...]:
        """Name and nominal frequency of each lamp [Hz]."""
        return tuple((name, lamp.frequency.si) for name, lamp in self.lamps.items())

    @property
    def route_beacons(self) -> tuple[tuple[str, float], ...]:
        """Return the lamps of the route as `beacons`, in order; none without a route."""
        beacons = dict(self.beacons)
        return tuple((name, beacons[name]) for name in self.route)

    @property
    def sun(self) -> DaylightScene | None:
        """Return the daylight of the scene, or of the place outside its door."""
        return self.daylight if self.outside is None else self.outside.daylight

    @property
    def light_field(self) -> LightField:
        """Return the light of the scene; `BadInput` where the light itself cannot be."""
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


def load_room_size(name: str) -> tuple[float, float, float] | None:
    """Return length, width and height of a scenario's room [m]; None without a name."""
    return to_triple(load_scenario(name).room.size) if name else None


def resolve_wind_file(content: Any, folder: Path) -> Any:
    """Return the content of a scenario file with the full path of its wind file."""
    try:
        wind_file = content['air']['recorded']
    except (KeyError, TypeError):
        return content
    if not isinstance(wind_file, str):
        return content
    place = str((folder / wind_file).absolute())
    return {**content, 'air': {**content['air'], 'recorded': place}}


LARGEST_OFFSET = 1000.0  # m; no scene is larger


def offset_start(scenario: Scenario, x: float, y: float) -> Scenario:
    """
    Return a scenario with the start moved; the same object for a zero offset.

    Raise `BadInput` if the drone would start outside of the room or within its goal.
    """
    if x == 0.0 and y == 0.0:
        return scenario
    if not (abs(x) <= LARGEST_OFFSET and abs(y) <= LARGEST_OFFSET):  # false for NaN too
        raise BadInput(
            f'The start offset is {x:g}, {y:g} m; give an offset_x and an offset_y from '
            f'{-LARGEST_OFFSET:g} to {LARGEST_OFFSET:g}.'
        )
    before = scenario.start.position.vector
    place = before[0] + x, before[1] + y
    start = scenario.start.model_copy(
        update={'position': Quantity(value=place, unit='m', source=scenario.start.position.source)}
    )
    # Validate anew: model_copy alone does not run the validators
    fields = {name: getattr(scenario, name) for name in Scenario.model_fields}
    for name, key in (('schema_version', 'schema'), ('alone', 'lamp'), ('several', 'lamps')):
        fields[key] = fields.pop(name)  # as the file has it
    try:
        return Scenario.model_validate({**fields, 'start': start})
    except ValidationError as error:
        # The scene without the offset was valid, so the only error is that of the start.
        fault = error.errors()[0]['msg'].removeprefix('Value error, ')
        fault = fault.partition(';')[0]  # the remedy after it is for the scenario file
        raise BadInput(
            f"With a start offset of {x:g}, {y:g} m the scenario '{scenario.name}' {fault}; "
            'give another offset_x or offset_y.'
        ) from None
