# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Represent the contents of one MCAP file, and read them from the summary of a finished one."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BytesIO
import os
import struct
from typing import BinaryIO, final
import zlib

from lta_bag.mcap_file.chunks import DamagedRecord, iterate_records, RECORD
from lta_bag.mcap_file.output import PROVENANCE
from lta_config.errors import strip_control_codes, to_one_line
from lta_config.limits import MOST_CHANNELS, NOTE_BYTES, SUMMARY_BYTES
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Metadata, MetadataIndex, Schema, Statistics
from mcap.writer import MCAP0_MAGIC

TOO_MANY = f'The recording has more than {MOST_CHANNELS} topics; the others are left out.'


@final
@dataclass(frozen=True, slots=True)
class MessageRegion:
    """
    A region of the file that contains messages [bytes from the start of the file].

    `packed` marks a chunk, otherwise the records are bare; `channels` is None if unknown. `is_cut`
    marks a chunk without its end.
    """

    offset: int
    length: int
    packed: bool
    channels: frozenset[int] | None
    is_cut: bool = False


@final
@dataclass(slots=True)
class McapContents:
    """
    Directory of one MCAP file.

    `counts` are messages by channel, `start` and `end` the first and last log time in ns. `losses`
    describe what is missing, `remarks` irregularities without loss.
    """

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    provenance: dict[str, str] = field(default_factory=dict)
    places: list[MessageRegion] = field(default_factory=list)
    counts: Counter[int] = field(default_factory=Counter)
    start: int | None = None
    end: int | None = None
    losses: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)

    def add_record(self, opcode: int, body: bytes) -> None:
        """
        Add a schema, channel or metadata record; other records and second copies are ignored.

        Raises
        ------
        DamagedRecord
            If the record cannot be read.

        """
        stream = ReadDataStream(BytesIO(body))
        try:
            if opcode == Opcode.SCHEMA:
                schema = Schema.read(stream)
                schema.name = to_one_line(schema.name)
                if schema.id:  # 0 means no schema
                    self.schemas.setdefault(schema.id, schema)
            elif opcode == Opcode.CHANNEL:
                channel = Channel.read(stream)
                channel.topic = to_one_line(channel.topic)
                if len(self.channels) >= MOST_CHANNELS and channel.id not in self.channels:
                    self._note_channel_limit()
                else:
                    self.channels.setdefault(channel.id, channel)
            elif opcode == Opcode.METADATA:
                metadata = Metadata.read(stream)
                if metadata.name == PROVENANCE:
                    self.provenance = strip_terminal_codes(metadata.metadata) | self.provenance
        except (struct.error, UnicodeDecodeError, McapError) as error:
            raise DamagedRecord from error

    def _note_channel_limit(self) -> None:
        """Add the remark that there are too many channels, once."""
        if TOO_MANY not in self.losses:
            self.losses.append(TOO_MANY)

    def count_message(self, channel: int, log_time: int) -> None:
        """Count a message."""
        self.counts[channel] += 1
        self.extend_time_span(log_time, log_time)

    def extend_time_span(self, start: int, end: int) -> None:
        """Extend the span of log times [ns]."""
        self.start = start if self.start is None else min(self.start, start)
        self.end = end if self.end is None else max(self.end, end)


def strip_terminal_codes(notes: Mapping[str, str]) -> dict[str, str]:
    """Return notes without terminal control codes."""
    return {to_one_line(key): strip_control_codes(text) for key, text in notes.items()}


def read_at(stream: BinaryIO, offset: int, length: int) -> bytes:
    """Read bytes of a file; raise DamagedRecord if it is too short."""
    if offset + length > stream.seek(0, os.SEEK_END):
        raise DamagedRecord
    stream.seek(offset)
    return stream.read(length)


FOOTER = struct.Struct('<BQQQI')  # opcode, length, summary, summary offsets, CRC
TAIL_SIZE = FOOTER.size + len(MCAP0_MAGIC)


def read_summary(stream: BinaryIO, size: int) -> McapContents | None:
    """Return the contents from a file's summary; None without a valid one."""
    try:
        start, section = read_summary_section(stream, size)
        return parse_summary(stream, start, section)
    except (DamagedRecord, struct.error, UnicodeDecodeError, McapError):
        return None


def read_summary_section(stream: BinaryIO, size: int) -> tuple[int, bytes]:
    """Return offset and bytes of the summary section; raise DamagedRecord if it is incomplete."""
    if size < TAIL_SIZE:
        raise DamagedRecord
    tail = read_at(stream, size - TAIL_SIZE, TAIL_SIZE)
    opcode, _, start, _, crc = FOOTER.unpack_from(tail)
    if (
        opcode != Opcode.FOOTER
        or not tail.endswith(MCAP0_MAGIC)
        or not 0 < start <= size - TAIL_SIZE
    ):
        raise DamagedRecord
    if size - TAIL_SIZE - start > SUMMARY_BYTES:
        raise DamagedRecord
    section = read_at(stream, start, size - TAIL_SIZE - start)
    # CRC 0 means not computed. It covers the footer up to the CRC itself.
    if crc and crc != zlib.crc32(section + tail[: FOOTER.size - 4]):
        raise DamagedRecord
    return start, section


def parse_summary(stream: BinaryIO, start: int, section: bytes) -> McapContents:
    """Return the contents in a summary section; raise DamagedRecord if it is inconsistent."""
    contents = McapContents()
    statistics = None
    notes = []
    for record in iterate_records(section):
        body = section[record.start : record.end]
        if record.opcode == Opcode.CHUNK_INDEX:
            chunk = ChunkIndex.read(ReadDataStream(BytesIO(body)))
            channels = frozenset(chunk.message_index_offsets) or None
            region = MessageRegion(chunk.chunk_start_offset, chunk.chunk_length, True, channels)
            contents.places.append(region)
        elif record.opcode == Opcode.STATISTICS:
            statistics = Statistics.read(ReadDataStream(BytesIO(body)))
        elif record.opcode == Opcode.METADATA_INDEX:
            notes.append(MetadataIndex.read(ReadDataStream(BytesIO(body))))
        else:
            contents.add_record(record.opcode, body)
    if statistics is None or not covers_all_messages(contents, statistics, start):
        raise DamagedRecord
    for note in notes:
        add_metadata(stream, contents, note)
    contents.counts.update(statistics.channel_message_counts)
    if statistics.message_count:
        contents.extend_time_span(statistics.message_start_time, statistics.message_end_time)
    return contents


def add_metadata(stream: BinaryIO, contents: McapContents, note: MetadataIndex) -> None:
    """Add a metadata record, or a remark if it is damaged."""
    try:
        if note.length > NOTE_BYTES:
            raise DamagedRecord
        data = read_at(stream, note.offset, note.length)
        opcode, length = RECORD.unpack_from(data)
        if opcode != Opcode.METADATA or length != len(data) - RECORD.size:
            raise DamagedRecord
        contents.add_record(opcode, data[RECORD.size :])
    except (DamagedRecord, struct.error):
        contents.remarks.append(f"The metadata record '{note.name}' is damaged and left out.")


def covers_all_messages(contents: McapContents, statistics: Statistics, data_end: int) -> bool:
    """Return whether the summary leads to every counted message exactly once."""
    after = len(MCAP0_MAGIC)
    for region in sorted(contents.places, key=lambda place: place.offset):
        if region.offset < after:
            return False
        after = region.offset + region.length
    return (
        after <= data_end
        and all(c.schema_id in contents.schemas for c in contents.channels.values() if c.schema_id)
        and len(contents.channels) == statistics.channel_count
        and len(contents.places) == statistics.chunk_count
        and (bool(contents.places) or statistics.message_count == 0)
    )


NAMELESS = '/channel_{}'  # cannot collide with a robot's topic, which has a namespace


def name_lost_channels(contents: McapContents) -> None:
    """Name the channels of a scanned file whose records are lost, with the chunk that had them."""
    for number in sorted(set(contents.counts) - set(contents.channels)):
        contents.channels[number] = Channel(number, NAMELESS.format(number), 'cdr', {}, 0)
        contents.remarks.append(
            f'The recording does not contain the topic name of channel {number}; its messages are '
            f"kept under the topic '{NAMELESS.format(number)}'."
        )
