# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Unpack the chunks of an MCAP file, with bounds on their sizes, and read their messages."""

from collections import deque
from collections.abc import Iterator
from contextlib import suppress
import struct
from typing import NamedTuple
import zlib

from lta_config.limits import CHUNK_BYTES
import lz4.frame
from mcap.opcode import Opcode
import zstandard


class DamagedRecord(Exception):
    """A damaged record; the text, if any, is the reason as a clause."""


def decompress(kind: str, packed: bytes | memoryview) -> bytes | memoryview:
    """
    Return the uncompressed data; bytes behind the end of a frame are ignored.

    `kind` is 'zstd', 'lz4' or '', which means uncompressed.

    Raises
    ------
    DamagedRecord
        If the kind is unknown, the frame is invalid, or it exceeds `CHUNK_BYTES`.

    """
    if kind == '':
        return packed
    try:
        if kind == 'zstd':
            return decompress_zstd(packed)
        if kind == 'lz4':
            return decompress_lz4(packed)
    except (zstandard.ZstdError, RuntimeError, ValueError, EOFError, MemoryError) as error:
        raise DamagedRecord from error
    raise DamagedRecord(
        f'are compressed with {kind!r}, which is not supported (only zstd and lz4 are)'
    )


def decompress_zstd(packed: bytes | memoryview) -> bytes:
    """Decompress a zstd frame; see `decompress`."""
    # A zstd frame header has at most 18 bytes.
    claimed = zstandard.frame_content_size(packed[:18])
    if claimed > CHUNK_BYTES:
        raise DamagedRecord(
            f'decompress to {claimed} bytes; the limit for a chunk is {CHUNK_BYTES} bytes'
        )
    if claimed >= 0:
        return zstandard.ZstdDecompressor().decompress(packed)
    with zstandard.ZstdDecompressor().stream_reader(packed) as stream:
        data = stream.read(CHUNK_BYTES + 1)
    if len(data) > CHUNK_BYTES:
        raise DamagedRecord(f'decompress to more than the limit of {CHUNK_BYTES} bytes')
    return data


def decompress_lz4(packed: bytes | memoryview) -> bytes:
    """Decompress an lz4 frame; see `decompress`."""
    unpacker = lz4.frame.LZ4FrameDecompressor()
    data: bytes = unpacker.decompress(packed, max_length=CHUNK_BYTES + 1)
    if len(data) > CHUNK_BYTES:
        raise DamagedRecord(f'decompress to more than the limit of {CHUNK_BYTES} bytes')
    if not unpacker.eof:
        raise DamagedRecord
    return data


RECORD = struct.Struct('<BQ')  # opcode, length
MESSAGE = struct.Struct('<HIQQ')  # channel, sequence, log time, publish time
BARE = struct.Struct('<BQHIQQ')  # a message record up to its data
CHUNK_HEAD_LAYOUT = struct.Struct(
    '<QQQII'
)  # start, end, size, CRC, length of the compression's name
LENGTH = struct.Struct('<Q')
LONGEST_NAME = 16  # bytes of the name of a compression


class McapRecord(NamedTuple):
    """The position of a record's body in a buffer [bytes]."""

    opcode: int
    start: int
    end: int


class McapMessage(NamedTuple):
    """A recorded message; its log time in ns."""

    channel: int
    log_time: int
    data: bytes


def iterate_records(data: bytes | memoryview) -> Iterator[McapRecord]:
    """Yield the records of a buffer in order; raise DamagedRecord if the last one is cut off."""
    at = 0
    while at < len(data):
        if at + RECORD.size > len(data):
            raise DamagedRecord
        opcode, length = RECORD.unpack_from(data, at)
        start = at + RECORD.size
        at = start + length
        if at > len(data):
            raise DamagedRecord
        yield McapRecord(opcode, start, at)


def unpack_chunk(body: bytes | memoryview) -> bytes | memoryview:
    """
    Return the records inside a chunk, given its body (without opcode and length).

    Raises
    ------
    DamagedRecord
        If it cannot be decompressed or its CRC is wrong.

    """
    size, crc, name, start, end = _read_chunk_head(body)
    if end > len(body):
        raise DamagedRecord
    data = decompress(name, body[start:end])
    if crc and zlib.crc32(data) != crc:
        raise DamagedRecord
    if not crc:  # not computed; then the sizes must agree
        if (len(data), end) != (size, len(body)):
            raise DamagedRecord
        deque(iterate_records(data), maxlen=0)
    return data


def _read_chunk_head(body: bytes | memoryview) -> tuple[int, int, str, int, int]:
    """Return size and CRC of the records in a chunk, their compression, and where they lie."""
    if len(body) < CHUNK_HEAD_LAYOUT.size + LENGTH.size:
        raise DamagedRecord
    _, _, size, crc, name_length = CHUNK_HEAD_LAYOUT.unpack_from(body)
    start = CHUNK_HEAD_LAYOUT.size + name_length + LENGTH.size
    if name_length > LONGEST_NAME or start > len(body):
        raise DamagedRecord
    name = bytes(body[CHUNK_HEAD_LAYOUT.size : start - LENGTH.size]).decode(errors='replace')
    return size, crc, name, start, start + LENGTH.unpack_from(body, start - LENGTH.size)[0]


def unpack_cut_chunk(body: bytes | memoryview) -> bytes:
    """Return the whole records in what is left of a chunk without its end; see `unpack_chunk`."""
    _, _, name, start, _ = _read_chunk_head(body)
    packed = bytes(body[start:])
    try:
        if name == 'zstd':
            with zstandard.ZstdDecompressor().stream_reader(packed) as stream:
                packed = stream.read(CHUNK_BYTES)
        elif name == 'lz4':
            unpacker = lz4.frame.LZ4FrameDecompressor()
            packed = unpacker.decompress(packed, max_length=CHUNK_BYTES)
        elif name:
            raise DamagedRecord
    except (zstandard.ZstdError, RuntimeError, ValueError, EOFError, MemoryError) as error:
        raise DamagedRecord from error
    end = 0
    with suppress(DamagedRecord):
        for record in iterate_records(packed):
            end = record.end
    return packed[:end]


def iterate_messages(data: bytes | memoryview, channels: frozenset[int]) -> Iterator[McapMessage]:
    """Yield the messages of the given channels."""
    at, size, unpack = 0, len(data), BARE.unpack_from
    last = size - BARE.size
    while at <= last:
        opcode, length, channel, _, log_time, _ = unpack(data, at)
        start = at + 9
        at = start + length
        if at > size:
            raise DamagedRecord
        if opcode == 5 and channel in channels:  # Opcode.MESSAGE; the enum is slow in this loop
            if length < 22:
                raise DamagedRecord
            yield McapMessage(channel, log_time, bytes(data[start + 22 : at]))
    for record in iterate_records(memoryview(data)[at:]):
        if record.opcode == Opcode.MESSAGE:  # shorter than its own header
            raise DamagedRecord
