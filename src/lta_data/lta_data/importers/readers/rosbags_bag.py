# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read rosbag2 recordings in SQLite and ROS 1 bags with the rosbags library.

ROS 1 messages become ROS 2 messages. If both have the same fields, the bytes are rewritten (ROS 2
headers have no sequence number). If ROS 2 has changed the type, fields are copied one by one and
new ones are zero. A type that ROS 2 lacks keeps the bag's own definition.
"""

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any, final

from lta_bag.reader import Bag, read_bag
from lta_bag.schemas import load_jazzy_types
from lta_bag.version_1 import refuse_old_bag
from lta_config.errors import BadInput
from lta_config.limits import limit_memory
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_data.importers.protocol import PassThroughMessage, RawTopic, Reached
from lta_data.importers.readers.bag_tables import (
    BagTableLog,
    build_tables,
    Decode,
    find_store_definition,
    list_mapping_tables,
    parse_qos_profiles,
    read_bag_definition,
)
from lta_data.importers.readers.sqlite_files import (
    CopyFolder,
    find_files,
    has_metadata,
    prepare_files,
    refuse_hostile_bag,
)
from rosbags.convert.converter import is_same_wireformat, migrate_bytes
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.typesys import get_typestore, Stores
from rosbags.typesys.store import Typestore

MESSAGES_PER_UPDATE = 2000  # messages between two updates of the progress bar


def open_mcap_log(path: Path, mapping: MappingFile | None) -> 'McapLog':
    """Open a recording in MCAP; raise `BadInput` if there is none."""
    try:
        return McapLog(path, mapping)
    except UnicodeDecodeError:
        raise BadInput(
            f"The topic names in '{path}' are damaged; import an intact copy."
        ) from None


@final
class McapLog(BagTableLog):
    """An opened recording; see `protocol.LogReader`."""

    timed: Sequence[str] = ()

    def __init__(self, path: Path, mapping: MappingFile | None) -> None:
        self._bag = read_bag(path)
        if mapping is None and self._bag.provenance:
            # A copy would look like an import, which no upgrade reads; foreign bags say nothing
            refuse_old_bag(path, self._bag.types, self._bag.provenance)
        self.notes: list[str] = []
        # Prefixed where a mapping reads the messages anew; else the flight is the same
        prefix = '' if mapping is None else 'original_'
        self.facts = {f'{prefix}{key}': text for key, text in self._bag.provenance.items()}
        if self._bag.losses:
            self.facts['losses'] = '\n'.join(self._bag.losses)
        self.raw: Mapping[str, RawTopic] = list_raw_topics(self._bag)
        self._total = max(1, sum(topic.count for topic in self._bag.topics.values()))
        self._tables = build_tables(
            list_mapping_tables(mapping), self.raw, self._iterate_decodable()
        )
        if not any(topic.count for topic in self._bag.topics.values()):
            why = ' '.join(self._bag.losses) or 'it contains none.'
            raise BadInput(f"'{path}' has no message that can be read: {why}")

    def iterate_messages(self, reached: Reached) -> Iterator[PassThroughMessage]:
        """Yield all messages in the order of recording."""
        for order, (topic, log_time, data) in enumerate(
            self._bag.iterate_messages(list(self.raw))
        ):
            if order % MESSAGES_PER_UPDATE == 0:
                reached(min(1.0, order / self._total))
            yield PassThroughMessage(order, topic, log_time, data)
        # At the end, since some damage is detected only while reading
        self.notes += [loss for loss in self._bag.losses if loss not in self.notes]

    def _iterate_decodable(self) -> Iterator[tuple[str, int, Decode]]:
        """Yield topic, log time in ns and a decoding function of every message."""
        for topic, log_time, data in self._bag.iterate_messages(list(self.raw)):
            yield topic, log_time, partial(self._decode_message, topic, data)

    def _decode_message(self, topic: str, data: bytes) -> object:
        try:
            return self._bag.decode(topic, data)
        except KeyError as part:
            raise BadInput(
                f"The message definition of topic '{topic}' lacks {part}; remove the topic "
                'from the mapping.'
            ) from None


def list_raw_topics(bag: Bag) -> dict[str, RawTopic]:
    """Return the topics with their definitions, whatever their encoding."""
    topics: dict[str, RawTopic] = {}
    for part in bag.parts:
        contents = part.contents
        for channel in contents.channels.values():
            # A channel without a schema gets None
            definition = read_bag_definition(channel, contents.schemas.get(channel.schema_id))
            qos = parse_qos_profiles(channel)
            topics.setdefault(channel.topic, RawTopic(definition, qos))
    return {name: raw for name, raw in topics.items() if name in bag.topics}


RENAMED = {'tf/msg/tfMessage': 'tf2_msgs/msg/TFMessage'}  # ROS 1 name -> ROS 2 name
ROS1 = b'#ROSBAG V'
Convert = Callable[[bytes], bytes]
Read = tuple[AnyReader, Connection, int, bytes]


def open_rosbags_log(path: Path, mapping: MappingFile | None) -> 'RosbagsLog':
    """Open a recording with rosbags; raise `BadInput` if it cannot be read."""
    if is_ros1(path) and path.suffix != '.bag':
        raise BadInput(
            f"'{path}' is a ROS 1 bag that was not closed; run `rosbag reindex` on it where ROS 1 "
            'is installed, and rename it to end with .bag.'
        )
    return RosbagsLog(path, mapping)


def is_ros1(path: Path) -> bool:
    """Return whether a file is a bag of ROS 1, by its first bytes."""
    if not path.is_file():
        return False
    with path.open('rb') as stream:
        return stream.read(len(ROS1)) == ROS1


@final
class RosbagsLog(BagTableLog):
    """An opened recording; see `protocol.LogReader`."""

    timed: Sequence[str] = ()

    def __init__(self, path: Path, mapping: MappingFile | None) -> None:
        # Before rosbags opens it
        files = find_files(path)
        refuse_hostile_bag(path, files)
        self._path = path
        databases = [file for file in files if file.suffix == '.db3']
        self._copies = CopyFolder()
        prepared = prepare_files(databases, self._copies)
        self._opened = [path]
        if prepared.files != databases or (path.is_dir() and not has_metadata(path)):
            self._opened = prepared.files
        self.notes: list[str] = prepared.notes
        self.facts: dict[str, str] = {}
        self._converters: dict[str, Convert] = {}
        self.raw: dict[str, RawTopic] = {}
        self._count = 0
        # Reading the first message registers the topics, and detects an empty bag.
        with closing(self._iterate_raw_messages()) as first:
            if next(first, None) is None:
                raise BadInput(f"'{path}' contains no message; give a bag with messages.")
        self._tables = build_tables(
            list_mapping_tables(mapping), self.raw, self._iterate_decodable()
        )

    def iterate_messages(self, reached: Reached) -> Iterator[PassThroughMessage]:
        """Yield all messages by log time."""
        for order, (_, connection, log_time, data) in enumerate(self._iterate_raw_messages()):
            if order % MESSAGES_PER_UPDATE == 0:
                reached(min(1.0, order / self._count))
            try:
                ours = self._converters[connection.topic](data)
            # rosbags raises many types for damaged messages
            except Exception as error:
                raise self._translate_error(error) from None
            yield PassThroughMessage(order, connection.topic, log_time, ours)

    def _iterate_raw_messages(self) -> Generator[Read, None, None]:
        """Yield reader, connection, log time in ns and raw message; errors become `BadInput`."""
        try:
            with (
                limit_memory(),
                AnyReader(self._opened, default_typestore=load_jazzy_types()) as reader,
            ):
                self._register_topics(reader)
                for connection, log_time, data in reader.messages():
                    yield reader, connection, log_time, bytes(data)
        except BadInput:
            raise
        except Exception as error:
            raise self._translate_error(error) from None

    def _translate_error(self, error: Exception) -> BadInput:
        """Return the error for a damaged bag; rosbags and SQLite raise many different ones."""
        reason = ' '.join(str(error).split()).rstrip('.') or type(error).__name__
        repair = 'rosbag reindex' if is_ros1(self._path) else 'ros2 bag reindex'
        return BadInput(
            f"'{self._path}' cannot be read ({reason}); repair it first with `{repair}`."
        )

    def _register_topics(self, reader: AnyReader) -> None:
        """Register the topics, once."""
        if self.raw:
            return
        # At least one, since the progress divides by it
        self._count = max(1, reader.message_count)
        types = reader.typestore if reader.is2 else build_ros2_typestore(reader.typestore)
        for connection in reader.connections:
            name, kind = connection.topic, connection.msgtype
            ours = kind if reader.is2 else RENAMED.get(kind, kind)
            if name in self.raw:
                if self.raw[name].definition.type_name != ours:
                    raise BadInput(
                        f"'{self._path}' has messages of several types on '{name}'; copy it "
                        'without this topic (ros2 bag convert) and import the copy.'
                    )
                continue
            self.raw[name] = RawTopic(find_store_definition(ours, types, self.notes))
            self._converters[name] = (
                bytes if reader.is2 else build_converter(reader.typestore, types, kind, ours)
            )

    def _iterate_decodable(self) -> Iterator[tuple[str, int, Decode]]:
        """Yield topic, log time in ns and a decoding function of every message."""
        for reader, connection, log_time, data in self._iterate_raw_messages():
            yield (
                connection.topic,
                log_time,
                partial(self._decode_message, reader, connection, data),
            )

    def _decode_message(self, reader: AnyReader, connection: Connection, data: bytes) -> object:
        try:
            return reader.deserialize(data, connection.msgtype)
        except Exception as error:
            raise self._translate_error(error) from None


def build_ros2_typestore(theirs: Typestore) -> Typestore:
    """Return the types of ROS 2 Jazzy, extended by those of a ROS 1 bag."""
    types = get_typestore(Stores.ROS2_JAZZY)
    types.register(
        {
            name: definition
            for name, definition in theirs.fielddefs.items()
            if name not in types.fielddefs
        }
    )
    return types


def build_converter(theirs: Typestore, types: Typestore, kind: str, ours: str) -> Convert:
    """Return a function that converts the bytes of a ROS 1 message to ROS 2."""
    if is_same_wireformat(theirs, types, kind, ours):
        return lambda data: bytes(types.ros1_to_cdr(data, ours))
    # rosbags stores its generated migration functions in it
    cache: dict[str, Any] = {}
    return lambda data: bytes(
        migrate_bytes(theirs, types, kind, ours, cache, data, src_is2=False, dst_is2=True)
    )
