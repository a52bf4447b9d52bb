"""Read the messages in chunk records of an MCAP file."""

from collections.abc import Callable, Iterator
import struct
from typing import NamedTuple
import zlib

from lta_config.limits import CHUNK_BYTES
from lta_data.bag.mcap_file.compression import (
    DamagedRecord,
    decompress,
    detect_compression,
    frame_length,
    KINDS,
    MAGICS,
)
from mcap.opcode import Opcode

RECORD = struct.Struct('<BQ')  # opcode, length
MESSAGE = struct.Struct('<HIQQ')  # channel, sequence, log time, publish time
BARE = struct.Struct('<BQHIQQ')  # a message record up to its data
HEAD = struct.Struct('<QQQII')  # start, end, size, CRC, length of the compression's name
LENGTH = struct.Struct('<Q')

Read = Callable[[int, int], bytes]  # offset and length to bytes; fewer at the file's end


class McapRecord(NamedTuple):
    """The position of a record's body in a buffer. [bytes]"""

    opcode: int
    start: int
    end: int


class McapMessage(NamedTuple):
    """A recorded message; times in ns."""

    channel: int
    sequence: int
    log_time: int
    publish_time: int
    data: bytes


class PackedLocation(NamedTuple):
    """Possible position of a chunk's packed records in its body, and their compression."""

    kind: str
    start: int
    length: int


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
        If it cannot be decompressed or its CRC is wrong for every reading of the header.

    """
    view = memoryview(body)
    return unpack_by_crc(lambda offset, length: view[offset : offset + length], len(body))[0]


def unpack_by_crc(
    read: Callable[[int, int], bytes | memoryview], length: int
) -> tuple[bytes | memoryview, int]:
    """
    Return the records inside a chunk and the end of its body.

    The header of a chunk is not covered by the CRC. If it is damaged, all plausible positions of
    the packed records are tried until the CRC is right.

    Parameters
    ----------
    read : callable
        Returns bytes by offset in the body and length; fewer at the end of the file.
    length : int
        Length of the body according to the record.

    Raises
    ------
    DamagedRecord
        As `unpack_chunk`.

    """
    head = read(0, HEAD.size + 16)
    if len(head) < HEAD.size + LENGTH.size:
        raise DamagedRecord
    reason = DamagedRecord()
    tried = set()
    for packed, has_length in iterate_candidates(head, length):
        if packed in tried:
            continue
        tried.add(packed)
        try:
            return unpack_candidate(read, packed, has_length, head, length)
        except DamagedRecord as error:
            reason = error if error.args else reason
    raise reason


def unpack_candidate(
    read: Callable[[int, int], bytes | memoryview],
    packed: PackedLocation,
    is_declared: bool,
    head: bytes | memoryview,
    length: int,
) -> tuple[bytes | memoryview, int]:
    """Unpack one candidate position of the packed records; see `unpack_by_crc`."""
    if packed.length > CHUNK_BYTES:
        raise DamagedRecord(
            f'declare a chunk of {packed.length} bytes, more than the limit of {CHUNK_BYTES} bytes'
        )
    part = read(packed.start, packed.length)
    if is_declared and len(part) < packed.length:
        raise DamagedRecord
    kind = detect_compression(packed.kind, part)
    data = decompress(kind, part)
    _, _, size, crc, _ = HEAD.unpack_from(head)
    end = packed.start + packed.length
    if crc and zlib.crc32(data) == crc:
        return data, end if is_declared else packed.start + frame_length(kind, part)
    # CRC 0 means not computed; then the lengths must agree exactly.
    if not crc and is_declared and (end, len(data)) == (length, size):
        return data, end
    raise DamagedRecord


def iterate_candidates(
    head: bytes | memoryview, length: int
) -> Iterator[tuple[PackedLocation, bool]]:
    """Yield possible positions of a chunk's packed records, and whether its header declares it."""
    _, _, size, _, name_length = HEAD.unpack_from(head)
    name = bytes(head[HEAD.size : HEAD.size + min(name_length, 8)]).decode(errors='replace')
    start = HEAD.size + name_length + LENGTH.size
    if start <= len(head):
        declared = LENGTH.unpack_from(head, start - LENGTH.size)[0]
        if declared <= length - start:
            yield PackedLocation(name, start, declared), True
    for kind in KINDS:
        start = HEAD.size + len(kind) + LENGTH.size
        if kind and bytes(head[start : start + 4]) not in MAGICS:
            continue
        declared = LENGTH.unpack_from(head, start - LENGTH.size)[0]
        for guess in (declared, length - start, size if kind == '' else CHUNK_BYTES):
            if 0 < guess <= CHUNK_BYTES:
                yield PackedLocation(kind, start, guess), False


def iterate_messages(data: bytes | memoryview, channels: frozenset[int]) -> Iterator[McapMessage]:
    """Yield the messages of the given channels."""
    at, size, unpack = 0, len(data), BARE.unpack_from
    last = size - BARE.size
    while at <= last:
        opcode, length, channel, sequence, log_time, publish_time = unpack(data, at)
        start = at + 9
        at = start + length
        if at > size:
            raise DamagedRecord
        if opcode == 5 and channel in channels:  # Opcode.MESSAGE; the enum is slow in this loop
            if length < 22:
                raise DamagedRecord
            body = bytes(data[start + 22 : at])
            yield McapMessage(channel, sequence, log_time, publish_time, body)
    for record in iterate_records(memoryview(data)[at:]):
        if record.opcode == Opcode.MESSAGE:  # shorter than its own header
            raise DamagedRecord
