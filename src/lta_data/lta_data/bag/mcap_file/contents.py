"""Represent the contents of one MCAP file, as known before any message is read."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BytesIO
import os
import struct
from typing import BinaryIO, final

from lta_bridge.bag.mcap_file import PROVENANCE
from lta_config.errors import strip_control_codes, to_one_line
from lta_config.limits import CHANNELS
from lta_data.bag.mcap_file.chunks import DamagedRecord
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema

TOO_MANY = f'The recording has more than {CHANNELS} topics; the others are left out.'


@final
@dataclass(frozen=True, slots=True)
class MessageRegion:
    """
    A region of the file that contains messages. [bytes from the start of the file]

    `packed` marks a chunk, otherwise the records are bare; `channels` is None if unknown. `start`
    and `end` are the first and last log time in ns, None if unknown.
    """

    offset: int
    length: int
    packed: bool
    channels: frozenset[int] | None
    start: int | None = None
    end: int | None = None


@final
@dataclass(slots=True)
class DamagedRegion:
    """
    A region of the file that cannot be used. [bytes from the start of the file]

    `start` and `end` are the first and last log time in it in ns, None if unknown. `chunks` is the
    number of chunks that it certainly contained, `reason` why it cannot be used, as a clause, if
    not for damage.
    """

    offset: int
    length: int
    chunks: int = 0
    reason: str = ''
    start: int | None = None
    end: int | None = None


@final
@dataclass(slots=True)
class McapContents:
    """
    Directory of one MCAP file.

    `counts` are messages by channel, `start` and `end` the first and last log time in ns. `losses`
    describe what is missing, `lost` where, and `remarks` irregularities without loss. `indexed`
    is whether everything comes from the file's summary.
    """

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    provenance: dict[str, str] = field(default_factory=dict)
    places: list[MessageRegion] = field(default_factory=list)
    counts: Counter[int] = field(default_factory=Counter)
    start: int | None = None
    end: int | None = None
    losses: list[str] = field(default_factory=list)
    lost: list[DamagedRegion] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    indexed: bool = field(default=False, compare=False)

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
                if len(self.channels) >= CHANNELS and channel.id not in self.channels:
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
        """Extend the span of log times. [ns]"""
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
