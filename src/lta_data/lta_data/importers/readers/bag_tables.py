# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Convert topics of a bag to tables: one row per message, one column per numeric field path.

`/tf#drone` is a separate table: the transforms of one child frame of a topic.
"""

from abc import ABC, abstractmethod
from collections.abc import (
    Callable,
    Collection,
    Container,
    Iterable,
    Iterator,
    Mapping,
    Sequence,
)
from dataclasses import replace
from itertools import islice
from typing import Any, cast, final, NamedTuple

from lta_bag.mcap_file.decoder import MISDEFINED, parse_definition
from lta_bag.metadata import OfferedQos
from lta_bag.schemas import load_jazzy_types, MessageDefinition
from lta_config.errors import BadInput
from lta_config.files import parse_yaml
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_config.schema.import_file import OrientationField, ScalarField, TopicMapping, VectorField
from lta_data.bag.columns import extract_field_columns, extract_stamp
from lta_data.importers.entry_plan import MESSAGE_SHAPES, MessagePart
from lta_data.importers.protocol import LogTable, Numbers
from mcap.records import Channel, Schema
import numpy as np
from rosbags.typesys import get_typestore, Stores
from rosbags.typesys.store import Typestore


def read_bag_definition(channel: Channel, schema: Schema | None) -> MessageDefinition:
    """Return a topic's definition from an MCAP file, with its REP-2016 hash if possible."""
    hashed = channel.metadata.get('topic_type_hash', '')
    if schema is None:
        return MessageDefinition('', '', hashed, '', channel.message_encoding)
    text = schema.data.decode(errors='surrogateescape')
    definition = MessageDefinition(
        schema.name, text, hashed, schema.encoding, channel.message_encoding
    )
    if hashed or definition.encoding != 'ros2msg':
        return definition
    types = get_typestore(Stores.EMPTY)
    try:
        types.register(
            parse_definition(definition.text, definition.type_name, definition.encoding)
        )
        return replace(definition, rihs01=types.hash_rihs01(definition.type_name))
    except MISDEFINED:
        return definition  # unreadable, but kept as it is


def parse_qos_profiles(channel: Channel) -> list[OfferedQos]:
    """Return the QoS that a topic's publishers offered; empty if unknown, or in numbers."""
    text = channel.metadata.get('offered_qos_profiles', '')
    try:
        listed: Any = parse_yaml(text, 'the QoS') if text else []
    except BadInput:
        return []
    named = isinstance(listed, list) and all(
        isinstance(one, dict) and isinstance(one.get('history'), str) for one in listed
    )
    return cast('list[OfferedQos]', listed) if named else []


def find_store_definition(type_name: str, types: Typestore, notes: list[str]) -> MessageDefinition:
    """Return a type's definition from a store; empty if it is unknown."""
    for store in (types, load_jazzy_types()):
        if type_name in store.fielddefs:
            text, _ = store.generate_msgdef(type_name, ros_version=2)
            return MessageDefinition(type_name, text, store.hash_rihs01(type_name))
    notes.append(
        f"Neither the bag nor ROS 2 Jazzy defines '{type_name}'; its messages are copied "
        'undecoded.'
    )
    return MessageDefinition(type_name, '', '')


TRANSFORMS = 'tf2_msgs/msg/TFMessage'
NAMED_POSES = 'motion_capture_tracking_interfaces/msg/NamedPoseArray'
RIGID_BODIES = 'mocap4r2_msgs/msg/RigidBodies'
# Types with several bodies: the list of them, and the name of each
BODY_TYPES: Mapping[str, tuple[str, str]] = {
    TRANSFORMS: ('transforms', 'child_frame_id'),
    NAMED_POSES: ('poses', 'name'),
    RIGID_BODIES: ('rigidbodies', 'rigid_body_name'),
}
MESSAGES_PER_PIECE = 10_000  # decoded messages held before conversion to numbers
CHILD_MARK = '#'  # separates a topic with several bodies and the name of one
BODY_SEARCH_MESSAGES = 3000  # messages in which the bodies of a topic are looked for
Decode = Callable[[], object]


def _pose_parts(position: str, orientation: str) -> Mapping[str, MessagePart]:
    return {
        'position': MessagePart(position, 'm', 'vector', 'world'),
        'orientation': MessagePart(orientation, '', 'attitude'),
    }


# Source types that are not import targets, by the parts that they provide.
FURTHER: Mapping[str, Mapping[str, MessagePart]] = {
    'geometry_msgs/msg/PoseWithCovarianceStamped': _pose_parts(
        'pose.pose.position', 'pose.pose.orientation'
    ),
    'geometry_msgs/msg/TransformStamped': _pose_parts(
        'transform.translation', 'transform.rotation'
    ),
    'geometry_msgs/msg/Pose': _pose_parts('position', 'orientation'),
    'geometry_msgs/msg/Wrench': {
        'force': MessagePart('force', 'N', 'vector', 'body'),
        'torque': MessagePart('torque', 'N m', 'axial', 'body'),
    },
    TRANSFORMS: _pose_parts('transform.translation', 'transform.rotation'),
    NAMED_POSES: _pose_parts('pose.position', 'pose.orientation'),
    RIGID_BODIES: _pose_parts('pose.position', 'pose.orientation'),
    'geometry_msgs/msg/TwistWithCovarianceStamped': {
        'velocity': MessagePart('twist.twist.linear', 'm/s', 'vector', 'body'),
        'rates': MessagePart('twist.twist.angular', 'rad/s', 'axial', 'body'),
    },
}


@final
class DecodedMessage(NamedTuple):
    """A decoded message with its position in the bag, log time and its own stamp in ns."""

    order: int
    log_time: int
    message: object
    stamp: int | None = None  # of a message around it


def build_message_table(met: Iterable[DecodedMessage]) -> LogTable:
    """Convert messages of one type to a table; one without a stamp gets its log time."""
    listed = list(met)
    numbers, _ = extract_field_columns(one.message for one in listed)
    stamps = [extract_stamp(one.message) for one in listed]
    times = np.array([one.log_time for one in listed], dtype=np.int64)
    own = [
        next(time for time in (stamp, one.stamp, one.log_time) if time is not None)
        for one, stamp in zip(listed, stamps, strict=True)
    ]
    return LogTable(
        np.array(own, dtype=np.int64),
        times,
        np.array([one.order for one in listed], dtype=np.int64),
        {path: np.asarray(values, dtype=np.float64) for path, values in numbers.items()},
    )


@final
class RowCollector:
    """Collects the messages of a table, converting them in batches to save memory."""

    def __init__(self) -> None:
        self._met: list[DecodedMessage] = []
        self._parts: list[LogTable] = []

    def add_messages(self, more: Iterable[DecodedMessage]) -> None:
        """Add messages."""
        self._met += more
        if len(self._met) >= MESSAGES_PER_PIECE:
            self._pack_pending()

    def finish_table(self) -> LogTable | None:
        """Return all messages as a table; None if there are none."""
        if self._met:
            self._pack_pending()
        if not self._parts:
            return None
        names = dict.fromkeys(name for part in self._parts for name in part.columns)
        return LogTable(
            np.concatenate([part.stamps for part in self._parts]),
            np.concatenate([part.log_times for part in self._parts]),
            np.concatenate([part.order for part in self._parts]),
            {name: self._join_column(name) for name in names},
        )

    def _pack_pending(self) -> None:
        self._parts.append(build_message_table(self._met))
        self._met = []

    def _join_column(self, name: str) -> Numbers:
        """Return a column of all parts; NaN in parts that lack it."""
        return np.concatenate(
            [part.columns.get(name, np.full(len(part), np.nan)) for part in self._parts]
        )


def select_child(met: DecodedMessage, child: str) -> list[DecodedMessage]:
    """Return the poses of one body in a message."""
    stamp = extract_stamp(met.message)
    return [
        met._replace(message=one, stamp=stamp)
        for name, one in _iterate_bodies(met.message)
        if name == child
    ]


def _iterate_bodies(message: object) -> Iterator[tuple[str, Any]]:
    """Yield the name and the pose of each body in a message."""
    for listed, name in BODY_TYPES.values():
        for one in getattr(message, listed, []):
            if hasattr(one, name):
                yield str(getattr(one, name)), one


def build_tables(
    names: Collection[str], available: Container[str], messages: Iterable[tuple[str, int, Decode]]
) -> dict[str, LogTable]:
    """
    Return the requested tables that exist.

    `names`: topics, or TOPIC#CHILD for transforms. `available`: the bag's topics. `messages`: all
    of the bag, in its order; read only if a requested topic exists.
    """
    # '/tf#base_link' selects one child frame of /tf
    topics = {name: name.split(CHILD_MARK)[0] for name in names}
    there = {name: topic for name, topic in topics.items() if topic in available}
    met = {name: RowCollector() for name in there}
    for order, (topic, log_time, decode) in enumerate(messages if there else ()):
        takers = [name for name, source_topic in there.items() if source_topic == topic]
        if not takers:
            continue
        # Decode lazily: messages of unused topics are never decoded
        one = DecodedMessage(order, log_time, decode())
        for name in takers:
            _, sign, child = name.partition(CHILD_MARK)
            met[name].add_messages(select_child(one, child) if sign else [one])
    tables = {name: rows.finish_table() for name, rows in met.items()}
    return {name: table for name, table in tables.items() if table is not None}


def list_mapping_tables(mapping: MappingFile | None) -> set[str]:
    """Return the tables that a mapping uses, which must be decoded."""
    if mapping is None:
        return set()
    tables = {entry.table for entry in mapping.topics if entry.table is not None}
    return tables.union(*(entry.join for entry in mapping.topics))


def complete_entry(entry: TopicMapping, type_name: str, target: str) -> TopicMapping:
    """
    Fill an entry that names no fields with the standard fields of the message type.

    `type_name` is the type in the bag, `target` that of the imported topic.

    Raise `BadInput` if no standard conversion is known.
    """
    # An explicit mapping takes precedence.
    if entry.parts or entry.actuators or entry.forces:
        return entry
    theirs = FURTHER.get(type_name) or MESSAGE_SHAPES.get(type_name, {})
    shared = {name: part for name, part in theirs.items() if name in MESSAGE_SHAPES[target]}
    if not shared:
        raise BadInput(
            f"Topic '{entry.table}' has type '{type_name}', which has no standard conversion to "
            f'{entry.topic}; in the mapping, name the fields to convert.'
        )
    return entry.model_copy(
        update={name: _build_mapping_part(part) for name, part in shared.items()}
    )


def _build_mapping_part(part: MessagePart) -> Any:
    """Return a part in the form of a mapping."""
    if part.kind == 'attitude':
        return OrientationField(quaternion=[f'{part.place}.{axis}' for axis in 'xyzw'])
    if part.kind == 'number':
        return ScalarField(column=part.place, unit=part.dimension, over=part.share * 1.0)
    return VectorField(columns=[f'{part.place}.{axis}' for axis in 'xyz'], unit=part.dimension)


def can_pass_unchanged(entry: TopicMapping, mapping: MappingFile, theirs: str, ours: str) -> bool:
    """Return whether a topic's messages can be passed on unchanged, under a new name."""
    has_parts = (
        entry.parts or entry.actuators or entry.forces or entry.where or entry.world or entry.body
    )
    moved = entry.stamps == 'log' or mapping.world is not None or mapping.body is not None
    return theirs == ours and not has_parts and not moved


class BagTableLog(ABC):
    """Base of the bag readers: the tables that the mapping uses, built on opening."""

    _tables: Mapping[str, LogTable]

    @abstractmethod
    def _iterate_decodable(self) -> Iterator[tuple[str, int, Decode]]:
        """Yield topic, log time in ns and a decoding function of every message."""

    def list_bodies(self, topic: str) -> list[str]:
        """Return the tables of the bodies in a topic, as '/tf#drone'."""
        names: dict[str, None] = {}
        messages = (decode for name, _, decode in self._iterate_decodable() if name == topic)
        for decode in islice(messages, BODY_SEARCH_MESSAGES):
            names |= dict.fromkeys(name for name, _ in _iterate_bodies(decode()))
        return [f'{topic}{CHILD_MARK}{name}' for name in names]

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """Return the columns of the tables that the mapping uses."""
        return {name: list(table.columns) for name, table in self._tables.items()}

    def read_tables(self, selection: Mapping[str, Collection[str]]) -> Mapping[str, LogTable]:
        """Return the tables that the mapping uses."""
        return {name: self._tables[name] for name in selection}
