"""What one MCAP file holds, known before any message is read."""

from collections import Counter
from dataclasses import dataclass, field
from io import BytesIO
import os
import struct
from typing import BinaryIO, final, NamedTuple

from lta_analysis.bag.chunks import Damaged
from lta_bridge.bag.records import PROVENANCE
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema


class Place(NamedTuple):
    """
    A stretch of the file that holds messages.

    `packed` tells a chunk from bare records; `channels` is None where it is not known which
    ones occur. [bytes from the file's start]
    """

    offset: int
    length: int
    packed: bool
    channels: frozenset[int] | None


@final
@dataclass(slots=True)
class Contents:
    """
    Directory of one MCAP file.

    `counts` are messages by channel, `start` and `end` the first and last log time in ns, and
    `losses` says in sentences what is missing.
    """

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    provenance: dict[str, str] = field(default_factory=dict)
    places: list[Place] = field(default_factory=list)
    counts: Counter[int] = field(default_factory=Counter)
    start: int | None = None
    end: int | None = None
    losses: list[str] = field(default_factory=list)

    def add(self, opcode: int, body: bytes) -> None:
        """
        Take note of a schema, channel or metadata record; others pass.

        Raises
        ------
        Damaged
            If the record cannot be read.

        """
        stream = ReadDataStream(BytesIO(body))
        try:
            if opcode == Opcode.SCHEMA:
                schema = Schema.read(stream)
                self.schemas[schema.id] = schema
            elif opcode == Opcode.CHANNEL:
                channel = Channel.read(stream)
                self.channels[channel.id] = channel
            elif opcode == Opcode.METADATA:
                metadata = Metadata.read(stream)
                if metadata.name == PROVENANCE:
                    self.provenance |= metadata.metadata
        except (struct.error, UnicodeDecodeError, McapError) as error:
            raise Damaged from error

    def count(self, channel: int, log_time: int) -> None:
        """Take note of a message."""
        self.counts[channel] += 1
        self.widen(log_time, log_time)

    def widen(self, start: int, end: int) -> None:
        """Take note of log times. [ns]"""
        self.start = start if self.start is None else min(self.start, start)
        self.end = end if self.end is None else max(self.end, end)


def read_at(stream: BinaryIO, offset: int, length: int) -> bytes:
    """Return bytes of a file; Damaged where it ends before."""
    if offset + length > stream.seek(0, os.SEEK_END):
        raise Damaged
    stream.seek(offset)
    return stream.read(length)
