"""Find the next record after a damaged region of a file."""

from collections.abc import Iterator
from typing import Any, Final

from lta_data.bag.mcap_file.chunks import HEAD, LENGTH, Read, RECORD
from lta_data.bag.mcap_file.compression import KINDS, MAGICS
from lta_data.bag.mcap_file.record_shape import LEAST
import numpy as np
from numpy.typing import NDArray

FIRST_WINDOW, LARGEST_WINDOW = 1 << 10, 1 << 18  # the next record is usually near
HEADS = 64  # bytes; longer than the header of any chunk
MARGIN = 128  # bytes read beyond a window, longer than the header of a chunk
SHORTEST: Final = np.array([*LEAST, *[1 << 62] * (256 - len(LEAST))], dtype=np.uint64)
CHUNK = 6  # Opcode.CHUNK
MAGIC_OF: Final = {kind: int.from_bytes(magic, 'little') for magic, kind in MAGICS.items()}


def find_candidate_offsets(
    read: Read, start: int, stop: int, size: int
) -> Iterator[tuple[int, bool]]:
    """
    Yield offsets before `stop` where a record can start, and whether it can be a chunk.

    `start` itself always comes first.

    A chunk is recognised by any two of: its opcode, the name of its compression, consistent
    lengths; or by the magic number of its packed data. So it is found even with a damaged header.

    `read`: returns bytes of the file by offset and length. `start`, `stop`, `size`: first offset,
    end of the search, and the file's size [bytes].
    """
    at, width = start, FIRST_WINDOW
    while at < stop:
        count = min(width, stop - at)
        data = read(at, count + MARGIN)
        if at > start and data.count(0) == len(data):  # preallocated space that was never used
            at, width = at + count, LARGEST_WINDOW
            continue
        window = np.frombuffer(data.ljust(count + MARGIN, b'\0'), np.uint8)
        chunks = find_chunk_heads(window, count, size - at)
        heads = find_record_heads(window, count, size - at)
        heads[0] |= at == start
        for place in np.flatnonzero(chunks | heads).tolist():
            yield at + place, bool(chunks[place])
        at += count
        width = min(2 * width, LARGEST_WINDOW)


def is_chunk_like(head: bytes, length: int) -> bool:
    """Return whether the first `HEADS` bytes of a record may be a chunk's, whatever its opcode."""
    for kind in KINDS:
        inside = HEAD.size + len(kind) + LENGTH.size
        at = RECORD.size + inside
        if len(head) < at + 4:
            continue
        if LENGTH.unpack_from(head, at - LENGTH.size)[0] + inside == length:
            return True
        if kind and int.from_bytes(head[at : at + 4], 'little') == MAGIC_OF[kind]:
            return True
    return False


def read_field(window: NDArray[np.uint8], count: int, offset: int, kind: str) -> NDArray[Any]:
    """Return the number at `offset` of a record that starts at each of `count` places."""
    return np.ndarray((count,), kind, window, offset, (1,))


def find_record_heads(window: NDArray[np.uint8], count: int, left: int) -> NDArray[np.bool_]:
    """Return where a known opcode is followed by a length that fits it and the file."""
    length = read_field(window, count, 1, '<u8')
    room = left - RECORD.size - np.arange(count)
    return (length >= SHORTEST[window[:count]]) & (length <= np.maximum(room, 0).astype(np.uint64))


def find_chunk_heads(window: NDArray[np.uint8], count: int, left: int) -> NDArray[np.bool_]:
    """Return where a chunk can start; see `find_candidate_offsets`."""
    opcode = window[:count] == CHUNK
    length = read_field(window, count, 1, '<u8')
    size = read_field(window, count, RECORD.size + 16, '<u8')
    name_length = read_field(window, count, RECORD.size + HEAD.size - 4, '<u4')
    is_head = np.zeros(count, np.bool_)
    for kind in KINDS:
        name_at = RECORD.size + HEAD.size
        inside = HEAD.size + len(kind) + 8
        packed = read_field(window, count, name_at + len(kind), '<u8')
        facts = opcode.astype(np.uint8)
        named = name_length == len(kind)
        for i, letter in enumerate(kind.encode()):
            named &= read_field(window, count, name_at + i, 'u1') == letter
        facts += named
        facts += (length == packed + np.uint64(inside)) & (packed > 0)
        if kind:
            magic = read_field(window, count, RECORD.size + inside, '<u4') == MAGIC_OF[kind]
            is_head |= magic | (facts >= 2) & (packed > 0) & (packed < left)
        else:
            facts += (size == packed) & (size > 0)
            facts += (length == size + np.uint64(inside)) & (size > 0)
            is_head |= (facts >= 2) & (np.minimum(packed, size) < left) & (packed | size > 0)
    return is_head
