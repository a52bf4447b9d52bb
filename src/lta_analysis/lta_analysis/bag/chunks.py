"""The packed part of an MCAP file: from a chunk record to the messages in it."""

from collections.abc import Iterator
from io import BytesIO
import struct
from typing import NamedTuple
import zlib

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Chunk
from mcap.stream_reader import get_chunk_data_stream
import zstandard

RECORD = struct.Struct('<BQ')  # opcode, length
MESSAGE = struct.Struct('<HIQQ')  # channel, sequence, log time, publish time
LARGEST_CHUNK = 1 << 30  # A chunk that claims more is damaged, not worth the memory.


class Damaged(Exception):
    """A record does not hold what it should."""


class Record(NamedTuple):
    """Where a record's body lies in a buffer. [bytes]"""

    opcode: int
    start: int
    end: int


def records(data: bytes) -> Iterator[Record]:
    """
    Yield the records of a buffer in order.

    Raises
    ------
    Damaged
        If the last one is cut.

    """
    at = 0
    while at < len(data):
        if at + RECORD.size > len(data):
            raise Damaged
        opcode, length = RECORD.unpack_from(data, at)
        start = at + RECORD.size
        at = start + length
        if at > len(data):
            raise Damaged
        yield Record(opcode, start, at)


def unpacked(body: bytes) -> bytes:
    """
    Return the records inside a chunk.

    Parameters
    ----------
    body : bytes
        The chunk record without opcode and length.

    Raises
    ------
    Damaged
        If it cannot be decompressed or its CRC does not hold.

    """
    try:
        chunk = Chunk.read(ReadDataStream(BytesIO(body)))
        if max(chunk.uncompressed_size, claimed_size(chunk)) > LARGEST_CHUNK:
            raise Damaged
        stream, length = get_chunk_data_stream(chunk)
        data = stream.read(length)
    except (McapError, zstandard.ZstdError, RuntimeError, ValueError, struct.error) as error:
        raise Damaged from error
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise Damaged
    return data


def claimed_size(chunk: Chunk) -> int:
    """Return what the compressed data say they hold; 0 where they do not say. [bytes]"""
    if chunk.compression != 'zstd':
        return 0
    return max(0, zstandard.frame_content_size(chunk.data))


def messages(data: bytes, channels: frozenset[int]) -> Iterator[tuple[int, int, bytes]]:
    """Yield channel, log time in ns and bytes of the messages of some channels."""
    for record in records(data):
        if record.opcode != Opcode.MESSAGE:
            continue
        if record.end - record.start < MESSAGE.size:
            raise Damaged
        channel, _, log_time, _ = MESSAGE.unpack_from(data, record.start)
        if channel in channels:
            yield channel, log_time, data[record.start + MESSAGE.size : record.end]
