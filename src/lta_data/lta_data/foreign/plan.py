"""
One entry of a mapping, checked against the message it is to become.

Everything that can be wrong without looking at a number is said here: unknown topics and parts,
units of the wrong dimension, a velocity of the world without an attitude.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.errors import BadInput, unknown
from lta_config.quantity import UNITS
from lta_config.schema.import_file import Entry, Mapping, Orientation, Scalar, Vector
from lta_config.topics import robot_topic
from lta_data.foreign.axes import attitude_matrix
from lta_data.foreign.shapes import JOINT_DIMENSIONS, JOINTS, Part, SHAPES, Target, target

Axes = tuple[str, ...]


@final
@dataclass(frozen=True, slots=True)
class Plan:
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

    entry: Entry
    topic: str
    target: Target
    world: Axes | None
    body: Axes | None

    @property
    def shape(self) -> dict[str, Part]:
        """The parts that the message has."""
        return dict(SHAPES[self.target.type_name])

    def axes(self, frame: str) -> Axes | None:
        """Return the axes of a frame, 'world' or 'body'."""
        return self.world if frame == 'world' else self.body

    def joints(self) -> Iterator[tuple[str, str, Scalar]]:
        """Yield actuator, field of the message and what is told, in the order of the mapping."""
        for name, actuator in (self.entry.actuators or {}).items():
            for field in JOINT_DIMENSIONS:
                told = getattr(actuator, field)
                if told is not None:
                    yield name, field, told


def plan(entry: Entry, mapping: Mapping, robot: str) -> Plan:
    """
    Return what becomes of an entry of a mapping.

    Raises
    ------
    BadInput
        If the topic cannot have what the entry tells.

    """
    found = Plan(
        entry,
        robot_topic(robot, entry.topic),
        target(entry.topic),
        entry.world or mapping.world,
        entry.body or mapping.body,
    )
    if found.target.type_name == JOINTS:
        _check_joints(found)
    elif entry.actuators is not None:
        raise BadInput(f"Topic '{entry.topic}' has no actuators; only motors has.")
    _check_parts(found)
    return found


def _check_parts(made: Plan) -> None:
    """Refuse parts that the message does not have, and units that do not fit."""
    entry, shape = made.entry, made.shape
    for name, given in entry.parts.items():
        if name not in shape:
            raise unknown(f'part of {entry.topic}', name, list(shape))
        if isinstance(given, Orientation):
            attitude_matrix(made.world, made.body)
            continue
        _check_unit(f'{entry.topic}: {name}', given, [shape[name].dimension])
        if isinstance(given, Vector) and given.frame not in (None, shape[name].frame):
            _check_frame(made, name, given)


def _check_frame(made: Plan, name: str, given: Vector) -> None:
    """Refuse a vector in axes from which there is no way into those of the message."""
    if given.frame != 'world' or made.entry.orientation is None:
        raise BadInput(
            f'{made.entry.topic}: {name} is given in the axes of the {given.frame}, but the '
            f'message wants those of the {made.shape[name].frame}; give the orientation beside '
            'it, or leave it out.'
        )


def _check_joints(made: Plan) -> None:
    """Refuse an entry without actuators, and units that do not fit."""
    told = list(made.joints())
    if not told and made.entry.table is None:
        raise BadInput(f"Topic '{made.entry.topic}' needs the key actuators: effort by name.")
    for name, field, given in told:
        _check_unit(f'{made.entry.topic}: {field} of {name}', given, JOINT_DIMENSIONS[field])


def _check_unit(what: str, given: Scalar | Vector, fitting: Sequence[str]) -> None:
    """Refuse a unit of another dimension, of a column or of a constant."""
    unit = given.unit if given.value is None else given.value.unit
    if UNITS[unit][0] not in fitting:
        wanted = ' or '.join(fitting)
        if unit == '1':
            raise BadInput(
                f'{what} has no unit; add "unit: {fitting[0]}", or what is like {wanted}.'
            )
        raise BadInput(f'{what} is in {unit}, but must be in {wanted} or its like.')
