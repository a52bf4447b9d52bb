"""
What people look at: `views.yaml`, and how a series in it names a field of a message.

    python -m lta_config.views foxglove > config/foxglove/lta.json
    python -m lta_config.views plotjuggler > config/plotjuggler/lta.xml

Tests hold the layouts in config/ against this.
"""

from collections.abc import Iterator, Mapping
from functools import cached_property
from importlib import import_module
import sys
from typing import Annotated, Literal, NamedTuple, Self

from lta_config.errors import BadInput, unknown_name
from lta_config.files import load_file, share_folder, StrictModel
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import is_name, load_topic_table, robot_topic, Topic
from pydantic import AliasChoices, Field, model_validator

KINDS = ('plot', 'states', 'scene', 'lamps', 'image', 'health', 'status')
LAYOUTS = ('foxglove', 'plotjuggler')
ANGLES = ('roll', 'pitch', 'yaw')


class ViewPanel(StrictModel):
    """One panel: exactly one of the kinds, and its title."""

    title: str
    share: Annotated[float, Field(gt=0.0)] = 1.0
    plot: Mapping[str, str] | None = None
    states: Mapping[str, str] | None = None
    scene: str | None = None
    lamps: str | None = None
    image: str | None = None
    health: str | None = None
    status: str | None = None
    named: str = ''

    @model_validator(mode='after')
    def _check_one_kind(self) -> Self:
        given = [kind for kind in KINDS if getattr(self, kind) is not None]
        if len(given) != 1:
            raise ValueError(f'must be one of {", ".join(KINDS)}; {self.title} is {given}')
        return self

    @property
    def kind(self) -> str:
        """Which of the kinds it is."""
        return next(kind for kind in KINDS if getattr(self, kind) is not None)

    @property
    def series(self) -> Mapping[str, str]:
        """What is drawn over time, by its label; nothing in other panels."""
        return self.plot or self.states or {}


class Views(StrictModel):
    """The whole declaration."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    robot: str
    vehicle: str
    tabs: Mapping[str, list[Annotated[list[ViewPanel], Field(min_length=1)]]]

    @model_validator(mode='after')
    def _check_robot_name(self) -> Self:
        if not is_name(self.robot):
            raise ValueError(f"has the robot '{self.robot}', which is no name")
        return self

    @cached_property
    def actuators(self) -> list[str]:
        """The actuators of the vehicle, in the order of `motors`."""
        return list(load_vehicle_file(self.vehicle).rotors)

    @property
    def largest_reading(self) -> float:
        """Largest reading of the vehicle's photodiodes. [counts]"""
        return load_vehicle_file(self.vehicle).sensors.diodes.largest_reading

    def iterate_panels(self) -> Iterator[ViewPanel]:
        """Yield every panel."""
        for columns in self.tabs.values():
            for column in columns:
                yield from column

    def absolute_topic(self, name: str) -> str:
        """Return the absolute name of a topic; an unknown one is a `BadInput`."""
        _ = load_topic_table()[name]
        return robot_topic(self.robot, name)


class SeriesPath(NamedTuple):
    """A series taken apart: its topic's name, row and absolute name, and the fields' names."""

    name: str
    topic: Topic
    absolute: str
    steps: tuple[str, ...]

    @property
    def angle(self) -> str:
        """Which angle of a quaternion is meant, empty for none."""
        *_, owner, last = ('', *self.steps)
        return last if owner == 'orientation' and last in ANGLES else ''


def parse_series(views: Views, series: str) -> SeriesPath:
    """
    Return a series taken apart.

    Raises
    ------
    BadInput
        If its topic is unknown, or it names no field.

    """
    name, *steps = series.split('.')
    if not steps or not all(steps):
        raise BadInput(f"The series '{series}' names no field; write TOPIC.FIELD.")
    return SeriesPath(name, load_topic_table()[name], views.absolute_topic(name), tuple(steps))


def load_views() -> Views:
    """Return the views that LTA ships."""
    return load_file(Views, share_folder() / 'views.yaml')


def main(words: list[str]) -> None:
    """Write one layout to standard output."""
    if len(words) != 1 or words[0] not in LAYOUTS:
        raise unknown_name('layout', ' '.join(words), list(LAYOUTS))
    maker = import_module(f'lta_config.views_{words[0]}')
    sys.stdout.write(maker.build_layout(load_views()))


if __name__ == '__main__':
    main(sys.argv[1:])
