"""
The views for Foxglove and PlotJuggler: `views.yaml`, and series that name a message field.

    python -m lta_config.views foxglove > config/foxglove/lta.json
    python -m lta_config.views plotjuggler > config/plotjuggler/lta.xml

Tests check that the layouts in config/ are up to date.
"""

from collections.abc import Iterator, Mapping
from functools import cached_property
from importlib import import_module
import sys
from typing import Annotated, Literal, NamedTuple, Self

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import load_file, share_folder, StrictModel
from lta_config.message_files import read_field_units
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import is_name, load_topic_table, robot_topic, Topic
from pydantic import AliasChoices, Field, model_validator

KINDS = ('plot', 'states', 'scene', 'block', 'health')
LAYOUTS = ('foxglove', 'plotjuggler')
ANGLES = ('roll', 'pitch', 'yaw')


class ViewPanel(StrictModel):
    """One panel: its title and exactly one of the kinds."""

    title: str
    share: Annotated[float, Field(gt=0.0)] = 1.0
    plot: Mapping[str, str] | None = None
    states: Mapping[str, str] | None = None
    scene: str | None = None
    block: str | None = None
    health: str | None = None

    @model_validator(mode='after')
    def _check_one_kind(self) -> Self:
        kinds = [kind for kind in KINDS if getattr(self, kind) is not None]
        if len(kinds) != 1:
            raise ValueError(
                f'has the panel "{self.title}" with {len(kinds)} kinds; give exactly one of '
                f'{", ".join(KINDS)}'
            )
        return self

    @property
    def kind(self) -> str:
        """The kind of the panel."""
        return next(kind for kind in KINDS if getattr(self, kind) is not None)

    @property
    def series(self) -> Mapping[str, str]:
        """The series of a plot by label; empty for other panels."""
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
            raise ValueError(
                f"has the robot '{self.robot}', which is not a valid namespace; use letters, "
                'digits '
                'and _'
            )
        return self

    @cached_property
    def actuators(self) -> list[str]:
        """The actuators of the vehicle, in the order of `motors`."""
        return list(load_vehicle_file(self.vehicle).rotors)

    def iterate_panels(self) -> Iterator[ViewPanel]:
        """Yield every panel."""
        for columns in self.tabs.values():
            for column in columns:
                yield from column

    def absolute_topic(self, name: str) -> str:
        """Return the absolute name of a topic; an unknown one is a `BadInput`."""
        # Raises BadInput for an unknown topic
        _ = load_topic_table()[name]
        return robot_topic(self.robot, name)


class SeriesPath(NamedTuple):
    """A parsed series: the topic's name, row and absolute name, and the names of the fields."""

    name: str
    topic: Topic
    absolute: str
    steps: tuple[str, ...]

    @property
    def angle(self) -> str:
        """The Euler angle that is selected from a quaternion; empty for none."""
        # The empty string is the owner of a path with a single field
        *_, owner, last = ('', *self.steps)
        return last if owner == 'orientation' and last in ANGLES else ''


def list_series(views: Views, panel: ViewPanel) -> list[tuple[str, SeriesPath]]:
    """Return the series of a panel with their labels, without those that the messages lack."""
    places = [(label, parse_series(views, series)) for label, series in panel.series.items()]
    return [(label, place) for label, place in places if place.steps]


def parse_series(views: Views, series: str) -> SeriesPath:
    """
    Parse a series 'TOPIC.FIELD...'; a field that the topic's message lacks has no steps.

    Raise `BadInput` if the topic is unknown or the field is missing.
    """
    name, *steps = series.split('.')
    if not steps or not all(steps):
        raise BadInput(
            f"The series '{series}' names no message field; write TOPIC.FIELD, as in "
            "'wind.vector.x'."
        )
    topic = load_topic_table()[name]
    field_steps = (
        tuple(steps) if topic.type == topic.declared_type else _find_standard_steps(topic, steps)
    )
    return SeriesPath(name, topic, views.absolute_topic(name), field_steps)


def _find_standard_steps(topic: Topic, steps: list[str]) -> tuple[str, ...]:
    """Return the path of a field in the standard type of a topic; () if there is none."""
    field, *rest = steps
    if topic.message == 'JointState' and field == 'duty':
        return ('effort', *rest)
    unit = read_field_units().get(topic.declared_type, {}).get(field)
    if topic.message == 'DiagnosticArray' and unit is not None:
        return ('energy', f'{field}_{unit}')
    return ()


def load_views() -> Views:
    """Return the views that LTA ships."""
    return load_file(Views, share_folder() / 'views.yaml')


def main(words: list[str]) -> None:
    """Write one layout to standard output."""
    if len(words) != 1 or words[0] not in LAYOUTS:
        raise unknown_name_error('layout', ' '.join(words), list(LAYOUTS))
    # Imported late, because both modules import this one
    maker = import_module(f'lta_config.views_{words[0]}')
    build_layout = getattr(maker, f'build_{words[0]}_layout')
    sys.stdout.write(build_layout(load_views()))


if __name__ == '__main__':
    main(sys.argv[1:])
