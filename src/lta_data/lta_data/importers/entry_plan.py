# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Check an entry of a mapping against the parts of its target message: units, axes and paths.

All errors that need no data are detected here: unknown topics and parts, units of the wrong
dimension, a world-frame velocity without an attitude.

Messages of one imported topic differ only in their numbers; texts and list lengths are equal. So
one message is serialised, and the others are copies of it with numbers written at the offsets that
the layout for reading has (`lta_data.bag.cdr_layout`).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final, Literal, NamedTuple

from lta_bag.schemas import load_jazzy_types
from lta_config.errors import BadInput, unknown_name_error
from lta_config.quantity import SI_UNITS
from lta_config.schema.import_file import (
    AppliedForce,
    ImportMapping,
    OrientationField,
    ScalarField,
    TopicMapping,
    VectorField,
)
from lta_config.topics import load_topic_table, robot_topic
from lta_data.bag.cdr_layout import CODES, derive_layout, TEXT
from lta_data.importers.axes import attitude_matrix
import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype

Kind = Literal['number', 'vector', 'axial', 'attitude']


@final
class MessagePart(NamedTuple):
    """One part of a message."""

    place: str  # path of the number, or of the parent of x, y, z (and w)
    dimension: str  # its SI unit; '' for an attitude
    # 'axial' for an axial vector, which a reflection leaves unchanged up to sign
    kind: Kind = 'number'
    frame: Literal['world', 'body', ''] = ''  # frame of a vector: 'world' or 'body'
    unknown: str = ''  # path of the element that is -1 if the part is unknown; '' if there is none
    share: float = 1.0  # message units per SI unit


@final
class ImportTarget(NamedTuple):
    """A topic that can be imported: message type and frame_id."""

    type_name: str
    frame: str


WRENCH = ImportTarget('geometry_msgs/msg/WrenchStamped', 'base_link')
JOINTS = 'sensor_msgs/msg/JointState'
JOINT_DIMENSIONS: Mapping[str, tuple[str, ...]] = {
    'effort': ('1', 'N', 'N m'),
    'position': ('m', 'rad'),
    'velocity': ('m/s', 'rad/s'),
}
# A command in a log may be a force or a place, which an ActuatorDuty cannot hold; and vehicles may
# be driven by body forces
EXTRA = {'motors': ImportTarget(JOINTS, 'base_link'), 'wrench_command': WRENCH}
CHILD_FRAMES = {'nav_msgs/msg/Odometry': {'child_frame_id': 'base_link'}}

# No covariance: an unknown quantity can only be NaN
_POSE = {
    'position': MessagePart('pose.position', 'm', 'vector', 'world'),
    'orientation': MessagePart('pose.orientation', '', 'attitude'),
}
MESSAGE_SHAPES: Mapping[str, Mapping[str, MessagePart]] = {
    'nav_msgs/msg/Odometry': {
        'position': MessagePart(
            'pose.pose.position', 'm', 'vector', 'world', 'pose.covariance[0]'
        ),
        # 6 x 6 covariance by rows: element 0 is x, element 21 is rotation about x
        'orientation': MessagePart(
            'pose.pose.orientation', '', 'attitude', '', 'pose.covariance[21]'
        ),
        'velocity': MessagePart(
            'twist.twist.linear', 'm/s', 'vector', 'body', 'twist.covariance[0]'
        ),
        'rates': MessagePart(
            'twist.twist.angular', 'rad/s', 'axial', 'body', 'twist.covariance[21]'
        ),
    },
    'sensor_msgs/msg/Imu': {
        'orientation': MessagePart('orientation', '', 'attitude', '', 'orientation_covariance[0]'),
        'rates': MessagePart(
            'angular_velocity', 'rad/s', 'axial', 'body', 'angular_velocity_covariance[0]'
        ),
        'acceleration': MessagePart(
            'linear_acceleration', 'm/s2', 'vector', 'body', 'linear_acceleration_covariance[0]'
        ),
    },
    'geometry_msgs/msg/PoseStamped': _POSE,
    'geometry_msgs/msg/TwistStamped': {
        'velocity': MessagePart('twist.linear', 'm/s', 'vector', 'body'),
        'rates': MessagePart('twist.angular', 'rad/s', 'axial', 'body'),
    },
    'geometry_msgs/msg/WrenchStamped': {
        'force': MessagePart('wrench.force', 'N', 'vector', 'body'),
        'torque': MessagePart('wrench.torque', 'N m', 'axial', 'body'),
    },
    'geometry_msgs/msg/Vector3Stamped': {
        'vector': MessagePart('vector', 'm/s', 'vector', 'world'),
    },
    'sensor_msgs/msg/BatteryState': {
        'voltage': MessagePart('voltage', 'V'),
        'current': MessagePart('current', 'A'),
        'temperature': MessagePart('temperature', 'degC'),
        'percentage': MessagePart('percentage', '1'),
        # BatteryState counts charge in ampere hours
        'charge': MessagePart('charge', 'C', share=1.0 / 3600.0),
        'capacity': MessagePart('capacity', 'C', share=1.0 / 3600.0),
    },
    'sensor_msgs/msg/Range': {
        'range': MessagePart('range', 'm'),
        'minimum': MessagePart('min_range', 'm'),
        'maximum': MessagePart('max_range', 'm'),
        'field_of_view': MessagePart('field_of_view', 'rad'),
    },
    'sensor_msgs/msg/FluidPressure': {'pressure': MessagePart('fluid_pressure', 'Pa')},
    'sensor_msgs/msg/Illuminance': {'illuminance': MessagePart('illuminance', 'lx')},
    JOINTS: {},
}
ELSEWHERE = ('light/bearing',)  # a vector, but without a unit of its own


def list_targets() -> dict[str, ImportTarget]:
    """Return the topics that an import can write, by relative name."""
    listed = {
        name: ImportTarget(topic.type, topic.frame)
        for name, topic in load_topic_table().topics.items()
        if topic.type in MESSAGE_SHAPES and name not in ELSEWHERE
    }
    return listed | EXTRA


def find_target(name: str) -> ImportTarget:
    """Return one target; raise `BadInput` with the known names if it is unknown."""
    targets = list_targets()
    if name not in targets:
        raise unknown_name_error('topic to import into', name, list(targets))
    return targets[name]


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
        """Return the parts of the target message."""
        return dict(MESSAGE_SHAPES[self.target.type_name])

    def find_axes(self, frame: str) -> Axes | None:
        """Return the axes of a frame, 'world' or 'body'."""
        return self.world if frame == 'world' else self.body

    @property
    def thrust_laws(self) -> dict[str, tuple[float, float, float]]:
        """Return the laws by actuator: thrust [N] = c0 + c1 w + c2 w |w|, with w in rad/s."""
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
    if SI_UNITS[unit][0] not in fitting:
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


Constants = Mapping[str, Sequence[str] | str | float]


@final
class CdrTemplate:
    """
    The bytes of one message of a ROS 2 Jazzy type, and the offsets of its numbers.

    Parameters
    ----------
    type_name : str
        For example 'nav_msgs/msg/Odometry'.
    constants : mapping of str to text, number or list of texts
        Values equal in all messages, by path: 'header.frame_id', 'name'.
    lengths : mapping of str to int
        Lengths of numeric lists by path; 0 by default.

    Attributes
    ----------
    places : dict of str to (int, dtype)
        Offset and type of each number by path: 'pose.pose.position.x', 'effort[0]'.

    """

    def __init__(
        self, type_name: str, constants: Constants, lengths: Mapping[str, int] | None = None
    ) -> None:
        types = load_jazzy_types()
        message = _build_message(type_name, '', constants, lengths or {})
        data = bytes(types.serialize_cdr(message, type_name))
        self._bytes = data + bytes(-len(data) % 4)

        def list_fields(name: str) -> list[tuple[str, Any]]:
            return types.fielddefs[name][1]

        self.places = {
            leaf.path if leaf.length is None else f'{leaf.path}[{index}]': (
                leaf.offset + index * kind.itemsize, kind
            )
            for leaf in derive_layout(type_name, self._bytes, list_fields).leaves
            if leaf.code != TEXT
            for kind in [np.dtype('<' + leaf.code)]
            for index in range(1 if leaf.length is None else leaf.length)
        }  # fmt: skip

    @property
    def size(self) -> int:
        """Size of every message [bytes]."""
        return len(self._bytes)

    def serialize_messages(self, count: int, numbers: Mapping[str, Any]) -> bytes:
        """
        Return `count` messages, one after the other.

        `numbers` are arrays of shape (count,) or () by path; other fields are as in the template.
        """
        kind = np.dtype(
            {
                'names': list(numbers),
                'formats': [self.places[path][1] for path in numbers],
                'offsets': [self.places[path][0] for path in numbers],
                'itemsize': self.size,
            }
        )
        raw: NDArray[np.uint8] = np.tile(np.frombuffer(self._bytes, dtype=np.uint8), count)
        rows = raw.view(kind)
        for path, values in numbers.items():
            # A structured view writes all messages at once.
            rows[path] = values
        return raw.tobytes()


def _build_message(
    type_name: str, prefix: str, constants: Constants, lengths: Mapping[str, int]
) -> object:
    """Return a message with the constants, and zeros or nothing in its other fields."""
    types = load_jazzy_types()
    values: dict[str, Any] = {}
    for name, (node, detail) in types.fielddefs[type_name][1]:
        path = f'{prefix}{name}'
        if node == Nodetype.NAME:
            values[name] = _build_message(str(detail), f'{path}.', constants, lengths)
        elif node == Nodetype.BASE:
            is_text = detail[0] == 'string'
            values[name] = constants.get(path, '' if is_text else 0)
        elif detail[0][1][0] == 'string':
            values[name] = [*constants.get(path, ())]  # type: ignore[misc]
        else:
            count = int(detail[1]) if node == Nodetype.ARRAY else lengths.get(path, 0)
            values[name] = np.zeros(count, CODES[detail[0][1][0]])
    return types.types[type_name](**values)
