"""
Check an entry of a mapping against its target message.

All errors that need no data are detected here: unknown topics and parts, units of the wrong
dimension, a world-frame velocity without an attitude.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.errors import BadInput, unknown_name_error
from lta_config.quantity import UNITS
from lta_config.schema.import_file import (
    AppliedForce,
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
    """A checked entry."""

    entry: TopicMapping  # as in the mapping
    topic: str  # absolute name
    target: ImportTarget
    # Axes of the log; None if they are LTA's, tuple of 3 str or None
    world: Axes | None
    body: Axes | None

    @property
    def target_parts(self) -> dict[str, MessagePart]:
        """The parts of the target message."""
        return dict(SHAPES[self.target.type_name])

    def find_axes(self, frame: str) -> Axes | None:
        """Return the axes of a frame, 'world' or 'body'."""
        return self.world if frame == 'world' else self.body

    @property
    def thrust_laws(self) -> dict[str, tuple[float, float, float]]:
        """The laws by actuator: thrust [N] = c0 + c1 w + c2 w |w|, with w in rad/s."""
        actuators = self.entry.actuators or {}
        return {name: one.thrust for name, one in actuators.items() if one.thrust is not None}

    def iterate_joints(self) -> Iterator[tuple[str, str, ScalarField]]:
        """Yield actuator, message field and source, in the order of the mapping."""
        for name, actuator in (self.entry.actuators or {}).items():
            for field in JOINT_DIMENSIONS:
                scalar = getattr(actuator, field)
                if scalar is not None:
                    yield name, field, scalar


def plan_entry(entry: TopicMapping, mapping: ImportMapping, robot: str) -> EntryPlan:
    """
    Check an entry of a mapping and return its plan.

    Raise `BadInput` if the target topic does not have what the entry gives.
    """
    plan = EntryPlan(
        entry,
        robot_topic(robot, entry.topic),
        find_target(entry.topic),
        entry.world or mapping.world,
        entry.body or mapping.body,
    )
    if plan.target.type_name == JOINTS:
        _check_joints(plan)
    elif entry.actuators is not None:
        raise BadInput(
            f"In the mapping, topic '{entry.topic}' cannot have the key 'actuators'; only the "
            "topic 'motors' can."
        )
    _check_parts(plan)
    return plan


def _check_parts(candidate: EntryPlan) -> None:
    """Raise BadInput for parts that the message lacks, and for wrong units."""
    entry, shape = candidate.entry, candidate.target_parts
    if entry.forces is not None:
        _check_forces(candidate, entry.forces)
    for name, part in entry.parts.items():
        if name not in shape:
            raise unknown_name_error(f'part of {entry.topic}', name, list(shape))
        if isinstance(part, OrientationField):
            # Raises BadInput if exactly one side is mirrored
            attitude_matrix(candidate.world, candidate.body)
            continue
        _check_unit(f'{entry.topic}: {name}', part, [shape[name].dimension])
        if isinstance(part, VectorField) and name not in ('force', 'torque'):
            _check_complete(entry.topic, name, part)
        if isinstance(part, VectorField) and part.frame not in (None, shape[name].frame):
            _check_frame(candidate, name, part)


def _check_forces(candidate: EntryPlan, forces: Sequence[AppliedForce]) -> None:
    """Raise BadInput for forces of a message without them, or beside their sum."""
    entry = candidate.entry
    if 'force' not in candidate.target_parts or entry.force:
        raise BadInput(
            f'In the mapping, topic \'{entry.topic}\' cannot have "forces": only wrench_command '
            'can, and without "force", which is their sum.'
        )
    for one in forces:
        _check_unit(f'{entry.topic}: forces', one, ['N'])
        if one.frame == 'world':
            raise BadInput(
                f'In the mapping, forces of {entry.topic} are in the world frame, but must be in '
                'the body frame; remove "frame".'
            )


def _check_complete(topic: str, name: str, vector: VectorField) -> None:
    """Raise BadInput for a vector without one of its columns."""
    if None in (vector.columns or ()):
        raise BadInput(
            f"In the mapping, {name} of topic '{topic}' lacks a column; only a force or a torque "
            'can, whose missing components are zero.'
        )


def _check_frame(candidate: EntryPlan, name: str, vector: VectorField) -> None:
    """Raise BadInput for a vector that cannot be rotated to the frame of the message."""
    # Only world to body is supported, and it needs the attitude of each row
    if vector.frame != 'world' or candidate.entry.orientation is None:
        raise BadInput(
            f"In the mapping, {name} of topic '{candidate.entry.topic}' is given in the "
            f'{vector.frame} frame, but the message needs the '
            f'{candidate.target_parts[name].frame} frame; give the orientation as well, or '
            f'leave {name} out.'
        )


def _check_joints(candidate: EntryPlan) -> None:
    """Raise BadInput for an entry without actuators, and for wrong units."""
    joints = list(candidate.iterate_joints())
    if not joints and candidate.entry.table is None:
        raise BadInput(
            f"In the mapping, topic '{candidate.entry.topic}' needs the key 'actuators', with the "
            'effort of each actuator by name.'
        )
    for name, field, scalar in joints:
        _check_unit(f'{candidate.entry.topic}: {field} of {name}', scalar, JOINT_DIMENSIONS[field])


def _check_unit(what: str, quantity: ScalarField | VectorField, fitting: Sequence[str]) -> None:
    """Raise BadInput for a unit of another dimension."""
    unit = quantity.unit if quantity.value is None else quantity.value.unit
    if UNITS[unit][0] not in fitting:
        expected = ' or '.join(fitting)
        if unit == '1':
            raise BadInput(
                f'{what} has no unit; add "unit: {fitting[0]}" to the mapping, or a unit '
                f'compatible with {expected}.'
            )
        raise BadInput(
            f'{what} is in {unit}, but must be in {expected} or a compatible unit; correct the '
            'mapping.'
        )
