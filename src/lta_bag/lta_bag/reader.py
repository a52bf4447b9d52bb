# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read a recording: its contents, and its messages one after the other.

Complete bags are opened by their summary, unfinished or damaged ones by their intact records.
Memory is limited to one chunk, whatever the size of the bag.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, final, NamedTuple

from lta_bag.bag_folder import (
    ADVICE,
    describe_absent_files,
    extract_provenance,
    find_bag_files,
    find_message_compression,
    read_metadata,
    wrong_format_error,
)
from lta_bag.mcap_file.chunks import (
    DamagedRecord,
    decompress,
    iterate_messages,
    McapMessage,
    RECORD,
    unpack_chunk,
    unpack_cut_chunk,
)
from lta_bag.mcap_file.contents import (
    McapContents,
    MessageRegion,
    name_lost_channels,
    read_at,
    read_summary,
)
from lta_bag.mcap_file.decoder import explain_undecodable, MessageDecoder
from lta_bag.mcap_file.scan import describe_damage, scan_mcap_file
from lta_config.errors import BadInput, unknown_name_error
from lta_config.limits import CHUNK_BYTES
from mcap.records import Channel, Schema
from mcap.writer import MCAP0_MAGIC


@final
@dataclass(frozen=True, slots=True)
class BagTopic:
    """
    One recorded topic.

    `undecodable` is the reason why its messages are kept but cannot be decoded, as a clause.
    """

    name: str
    type_name: str
    count: int
    undecodable: str | None = None


class RecordingFile(NamedTuple):
    """One file of a bag."""

    file: Path
    contents: McapContents
    refused: BadInput | None = None


def find_message_type(contents: McapContents, channel: Channel) -> str:
    """Return the message type of a channel; empty if unknown."""
    schema = contents.schemas.get(channel.schema_id)
    return '' if schema is None else schema.name


@final
class Bag:
    """
    An opened recording; see `read_bag`.

    Attributes
    ----------
    topics : dict of str to BagTopic
        The recorded topics by absolute name.
    parts : list of RecordingFile
        Its files and their contents.
    provenance : dict of str to str
        As the recorder stored it.
    start, end : int or None
        First and last log time; None without messages. [ns]
    size : int
        Size of the MCAP files. [bytes]
    losses : list of str
        What is missing, one sentence each; grows if reading finds damage.
    remarks : list of str
        Irregularities without loss, one sentence each.

    """

    def __init__(
        self, path: Path, parts: list[RecordingFile], described: dict[str, object]
    ) -> None:
        self.path = path
        self._message_kind = find_message_compression(described)
        self.parts = parts
        self.size = sum(file.stat().st_size for file, *_ in parts)
        self.losses = [loss for _, contents, _ in parts for loss in contents.losses]
        self.remarks = [remark for _, contents, _ in parts for remark in contents.remarks]
        self.provenance = extract_provenance(described)
        for _, contents, _ in parts:
            self.provenance |= contents.provenance
        self.start = min((c.start for _, c, _ in parts if c.start is not None), default=None)
        self.end = max((c.end for _, c, _ in parts if c.end is not None), default=None)
        self._schemas: dict[str, Schema] = {}
        self.topics: dict[str, BagTopic] = {}
        for _, contents, _ in parts:
            self._add_topics(contents)
        self._decoder = MessageDecoder(self._schemas)

    @property
    def types(self) -> dict[str, str]:
        """Return the message type of each topic."""
        return {name: topic.type_name for name, topic in self.topics.items()}

    @property
    def duration(self) -> float:
        """Time from the first to the last message [s]."""
        return 0.0 if self.start is None or self.end is None else (self.end - self.start) * 1e-9

    @property
    def is_complete(self) -> bool:
        """Whether the recording was finished and nothing is known to be missing."""
        return not self.losses

    def iterate_messages(
        self, topics: Collection[str] | None = None
    ) -> Iterator[tuple[str, int, bytes]]:
        """
        Yield topic, log time in ns and CDR bytes in the order of recording.

        `topics` are absolute names; None for all.

        Raise `BadInput` if a topic is not in the bag.
        """
        requested = set(self.topics if topics is None else topics)
        for name in sorted(requested - set(self.topics)):
            raise unknown_name_error('topic', name, list(self.topics))
        for part in self.parts:
            names = self._select_channels(part.contents, requested)
            channels = frozenset(names)
            with part.file.open('rb') as stream:
                for place in part.contents.places:
                    if place.channels is None or not channels.isdisjoint(place.channels):
                        for channel, log_time, data in self._read_region(stream, place, channels):
                            yield names[channel], log_time, data

    def decode(self, topic: str, data: bytes) -> object:
        """Decode a message of a topic; raise `BadInput` if that is impossible."""
        entry = self.topics[topic]
        if entry.undecodable is not None:
            raise BadInput(
                f"The messages of '{topic}' {entry.undecodable}; they are kept but cannot be "
                'decoded. Leave this topic out.'
            )
        return self._decoder.decode(entry.type_name, data)

    def iterate_values(self, topic: str) -> Iterator[bytes]:
        """Yield the messages of a topic with zeros as padding: equal if their values are."""
        type_name = self.topics[topic].type_name
        for _, _, data in self.iterate_messages([topic]):
            yield self._decoder.encode_again(type_name, data)

    def list_fields(self, type_name: str) -> list[tuple[str, Any]]:
        """Return the fields of a type of messages in the bag; see `MessageDecoder.list_fields`."""
        return self._decoder.list_fields(type_name)

    def _add_topics(self, contents: McapContents) -> None:
        """Register the topics of one file."""
        for channel in contents.channels.values():
            schema = contents.schemas.get(channel.schema_id)
            type_name = find_message_type(contents, channel)
            entry = self.topics.get(channel.topic)
            # A table can hold one message type only.
            if entry is not None and entry.type_name != type_name:
                self._note_loss(
                    f"Topic '{channel.topic}' has messages of type '{entry.type_name}' and of "
                    f"'{type_name}'; the latter are left out."
                )
                continue
            if schema is not None:
                self._schemas.setdefault(type_name, schema)
            count = contents.counts[channel.id] + (0 if entry is None else entry.count)
            reason = explain_undecodable(schema, channel.message_encoding)
            self.topics[channel.topic] = BagTopic(channel.topic, type_name, count, reason)

    def _select_channels(self, contents: McapContents, topics: set[str]) -> dict[int, str]:
        """Return the requested topics of one file, by channel."""
        return {
            number: channel.topic
            for number, channel in contents.channels.items()
            if channel.topic in topics
            and self.topics[channel.topic].type_name == find_message_type(contents, channel)
        }

    def _read_region(
        self, stream: BinaryIO, place: MessageRegion, channels: frozenset[int]
    ) -> Iterator[McapMessage]:
        try:
            # Do not allocate memory for a damaged length.
            if place.length > 2 * CHUNK_BYTES:
                raise DamagedRecord(
                    f'are declared as a chunk of {place.length} bytes, more than the limit of '
                    f'{2 * CHUNK_BYTES} bytes'
                )
            data: bytes | memoryview = read_at(stream, place.offset, place.length)
            if place.packed:
                unpack = unpack_cut_chunk if place.is_cut else unpack_chunk
                data = unpack(memoryview(data)[RECORD.size :])
            messages = iterate_messages(data, channels)
            yield from map(self._decompress_message, messages) if self._message_kind else messages
        except DamagedRecord as error:
            self._note_loss(describe_damage(place.offset, place.length, str(error)))

    def _decompress_message(self, message: McapMessage) -> McapMessage:
        """Decompress a message that was compressed on its own."""
        return message._replace(data=bytes(decompress(self._message_kind, message.data)))

    def _note_loss(self, loss: str) -> None:
        """Add a loss, once."""
        if loss not in self.losses:
            self.losses.append(loss)


def read_bag(path: Path | str) -> Bag:
    """
    Open a recording.

    `path` is a rosbag2 folder or an .mcap file; complete, cut short or damaged.

    Raise `BadInput` if there is no recording at `path`.
    """
    path = Path(path)
    try:
        described = read_metadata(path) if path.is_dir() else {}
        parts = [open_bag_file(file) for file in find_bag_files(path, described)]
        if parts[0].refused is not None and all(part.refused for part in parts):
            raise parts[0].refused
        bag = Bag(path, parts, described)
    except OSError as error:
        raise BadInput(f"'{path}' cannot be read ({error.strerror}); {ADVICE}.") from error
    bag.losses += describe_absent_files(path, described)
    return bag


def open_bag_file(file: Path) -> RecordingFile:
    """Open one file of a bag; an unreadable file counts as lost."""
    try:
        return RecordingFile(file, read_file_contents(file))
    except BadInput as error:
        return RecordingFile(file, McapContents(losses=[str(error)]), error)


def read_file_contents(file: Path) -> McapContents:
    """Return the contents of one MCAP file, from its summary if that is valid."""
    size = file.stat().st_size
    with file.open('rb') as stream:
        head = stream.read(32)
        if not head.startswith(MCAP0_MAGIC):
            raise wrong_format_error(file, head)
        contents = read_summary(stream, size)
        if contents is None:
            contents = scan_mcap_file(stream, size)
            name_lost_channels(contents)
        return contents
