"""
One entry of a mapping, checked against the message it is to become.

Everything that can be wrong without looking at a number is said here: unknown topics and parts,
units of the wrong dimension, a velocity of the world without an attitude.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.errors import BadInput, unknown_name
from lta_config.quantity import UNITS
from lta_config.schema.import_file import (
    ImportMapping,
    OrientationField,
    ScalarField,
    TopicMapping,
    VectorField,
)
from lta_config.topics import robot_topic
from lta_data.importers.axes import attitude_matrix
from lta_data.importers.message_parts import (
    find_target,
    ImportTarget,
    JOINT_DIMENSIONS,
    JOINTS,
    MessagePart,
    SHAPES,
)

Axes = tuple[str, ...]


@final
@dataclass(frozen=True, slots=True)
class EntryPlan:
    """
    What becomes of an entry.

    Attributes
    ----------
    entry : Entry
        As the mapping has it.
    topic : str
        Absolute name.
    target : Target
        Its type and frame.
    world, body : tuple of 3 str or None
        Their axes; ours if None.
    vehicle : str
        The drone that the actuators are of, for messages.

    """

    entry: TopicMapping
    topic: str
    target: ImportTarget
    world: Axes | None
    body: Axes | None

    @property
    def parts(self) -> dict[str, MessagePart]:
        """The parts that the message has."""
        return dict(SHAPES[self.target.type_name])

    def find_axes(self, frame: str) -> Axes | None:
        """Return the axes of a frame, 'world' or 'body'."""
        return self.world if frame == 'world' else self.body

    def iterate_joints(self) -> Iterator[tuple[str, str, ScalarField]]:
        """Yield actuator, field of the message and what is told, in the order of the mapping."""
        for name, actuator in (self.entry.actuators or {}).items():
            for field in JOINT_DIMENSIONS:
                told = getattr(actuator, field)
                if told is not None:
                    yield name, field, told


def plan_entry(entry: TopicMapping, mapping: ImportMapping, robot: str) -> EntryPlan:
    """
    Return what becomes of an entry of a mapping.

    Raises
    ------
    BadInput
        If the topic cannot have what the entry tells.

    """
    found = EntryPlan(
        entry,
        robot_topic(robot, entry.topic),
        find_target(entry.topic),
        entry.world or mapping.world,
        entry.body or mapping.body,
    )
    if found.target.type_name == JOINTS:
        _check_joints(found)
    elif entry.actuators is not None:
        raise BadInput(f"Topic '{entry.topic}' has no actuators; only motors has.")
    _check_parts(found)
    return found


def _check_parts(candidate: EntryPlan) -> None:
    """Refuse parts that the message does not have, and units that do not fit."""
    entry, shape = candidate.entry, candidate.parts
    for name, given in entry.parts.items():
        if name not in shape:
            raise unknown_name(f'part of {entry.topic}', name, list(shape))
        if isinstance(given, OrientationField):
            attitude_matrix(candidate.world, candidate.body)
            continue
        _check_unit(f'{entry.topic}: {name}', given, [shape[name].dimension])
        if isinstance(given, VectorField) and given.frame not in (None, shape[name].frame):
            _check_frame(candidate, name, given)


def _check_frame(candidate: EntryPlan, name: str, vector: VectorField) -> None:
    """Refuse a vector in axes from which there is no way into those of the message."""
    if vector.frame != 'world' or candidate.entry.orientation is None:
        raise BadInput(
            f'{candidate.entry.topic}: {name} is given in the axes of the {vector.frame}, but the '
            f'message wants those of the {candidate.parts[name].frame}; give the orientation '
            f'beside '
            'it, or leave it out.'
        )


def _check_joints(candidate: EntryPlan) -> None:
    """Refuse an entry without actuators, and units that do not fit."""
    told = list(candidate.iterate_joints())
    if not told and candidate.entry.table is None:
        raise BadInput(f"Topic '{candidate.entry.topic}' needs the key actuators: effort by name.")
    for name, field, given in told:
        _check_unit(f'{candidate.entry.topic}: {field} of {name}', given, JOINT_DIMENSIONS[field])


def _check_unit(what: str, quantity: ScalarField | VectorField, fitting: Sequence[str]) -> None:
    """Refuse a unit of another dimension, of a column or of a constant."""
    unit = quantity.unit if quantity.value is None else quantity.value.unit
    if UNITS[unit][0] not in fitting:
        wanted = ' or '.join(fitting)
        if unit == '1':
            raise BadInput(
                f'{what} has no unit; add "unit: {fitting[0]}", or what is like {wanted}.'
            )
        raise BadInput(f'{what} is in {unit}, but must be in {wanted} or its like.')
