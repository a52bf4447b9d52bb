"""
Validate the records of a damaged file, and find the next valid one.

A chunk is valid if its CRC is right. Other records have no CRC: they are valid if their fields
fill them exactly, or if another record starts at their end.
"""

from collections import deque
from collections.abc import Container
from typing import final, NamedTuple

from lta_config.limits import NOTE_BYTES
from lta_data.bag.mcap_file.chunks import MESSAGE, Read, RECORD, unpack_by_crc
from lta_data.bag.mcap_file.compression import DamagedRecord
from lta_data.bag.mcap_file.record_shape import is_plausible_head, is_well_formed, SHAPES
from lta_data.bag.mcap_file.resync import find_candidate_offsets, HEADS, is_chunk_like
from mcap.opcode import Opcode

PRIVATE = 0x80  # opcodes from here on are private; MCAP defines none beyond DATA_END
ENOUGH = 1 << 26  # bytes of futile search per file, beyond eight times its size
A_SEARCH = 20_000  # least cost of a search, in bytes
A_CHUNK = 1 << 20  # cost of an attempt to unpack, in bytes


class ValidRecord(NamedTuple):
    """A valid record: its opcode, its end, and its body or the unpacked chunk."""

    opcode: int
    end: int
    body: bytes | memoryview


@final
class RecordProber:
    """
    Separates the records of one file from damaged bytes.

    Parameters
    ----------
    read : callable
        Returns bytes of the file by offset and length.
    size : int
        The file's size. [bytes]
    channels : container of int
        The channels known so far.

    Attributes
    ----------
    before : deque of int
        Offsets of the last records without a CRC, since the last chunk.
    reason : str
        Why the last invalid chunk cannot be used, if not for damage.

    """

    def __init__(self, read: Read, size: int, channels: Container[int]) -> None:
        self._read = read
        self._size = size
        self._channels = channels
        self._effort = 8 * size + ENOUGH
        self._chunked = False  # messages come in chunks
        self._doubt = False  # a bare message may be inside a damaged chunk
        self.before: deque[int] = deque(maxlen=4)
        self.reason = ''

    def accept_record(self, at: int, record: ValidRecord) -> None:
        """Update the state after a valid record."""
        if record.opcode == Opcode.CHUNK:
            self._chunked, self._doubt = True, False
            self.before.clear()
        else:
            self.before.append(at)

    def read_record(self, at: int, chunk: bool = False) -> ValidRecord | None:
        """Return the record at an offset if it is valid; with `chunk` it must be a chunk."""
        opcode, length = self.read_record_header(at)
        end = at + RECORD.size + length
        if opcode == Opcode.CHUNK or chunk:
            return self._read_chunk(at, length)
        if opcode == 0 or Opcode.DATA_END < opcode < PRIVATE or end > self._size:
            return None
        if opcode in SHAPES:
            body = self._read(at + RECORD.size, min(length, NOTE_BYTES + 1))
            holds = is_well_formed(opcode, body) and not self._is_too_long(at, end)
            return ValidRecord(opcode, end, body) if holds else None
        return self._read_unverified(at, opcode, end)

    def read_record_header(self, at: int) -> tuple[int, int]:
        """Return opcode and length of the record at an offset; 0 beyond the end of the file."""
        opcode, length = RECORD.unpack(self._read(at, RECORD.size).ljust(RECORD.size, b'\0'))
        return opcode, length

    def _read_chunk(self, at: int, length: int) -> ValidRecord | None:
        """Return a chunk with a correct CRC."""
        start = at + RECORD.size
        try:
            data, used = unpack_by_crc(
                lambda offset, count: self._read(start + offset, count), length
            )
        except DamagedRecord as error:
            self.reason = str(error)
            return None
        return ValidRecord(Opcode.CHUNK, min(start + used, self._size), data)

    def _read_unverified(self, at: int, opcode: int, end: int) -> ValidRecord | None:
        """Return a record that only its successor confirms: a bare message or an attachment."""
        head = self._read(at, HEADS)
        length = end - at - RECORD.size
        body = head[RECORD.size : RECORD.size + MESSAGE.size]
        if opcode == Opcode.MESSAGE and (
            length < MESSAGE.size or not self._is_plausible_message(at, body, end)
        ):
            return None
        if is_chunk_like(head, length):
            return None  # a chunk with a wrong opcode; the search finds it by its CRC
        return None if self._is_too_long(at, end) else ValidRecord(opcode, end, body)

    def _is_too_long(self, at: int, end: int) -> bool:
        """Return whether a length is wrong: no record starts at its end, but one before."""
        return (
            not self._is_possible_record_start(end)
            and self._find_valid_record(at, end) is not None
        )

    def _is_plausible_message(self, at: int, body: bytes, end: int) -> bool:
        """Return whether a bare message is plausible in a file whose messages come in chunks."""
        if self._doubt:
            return False
        if not self._chunked:
            return True
        channel = MESSAGE.unpack(body)[0]
        index = end - at < NOTE_BYTES and is_well_formed(
            Opcode.MESSAGE_INDEX, self._read(at + RECORD.size, end - at - RECORD.size)
        )
        return channel in self._channels and not index

    def _is_possible_record_start(self, at: int) -> bool:
        """Return whether a record, or the end of the file, can be at an offset."""
        if self._size - at < RECORD.size:
            return True
        opcode, length = self.read_record_header(at)
        return is_plausible_head(opcode, length) or opcode >= PRIVATE

    def find_resume_offset(self, at: int) -> tuple[int, bool] | None:
        """Return the offset behind an invalid record to continue at, and if it must be a chunk."""
        opcode, length = self.read_record_header(at)
        end = at + RECORD.size + length
        framed = (
            opcode == Opcode.CHUNK and end < self._size and self._is_possible_record_start(end)
        )
        self._chunked |= opcode == Opcode.CHUNK
        self._doubt = self._chunked
        reason = self.reason
        resume = self._find_overrun_chunk(at) or self._find_valid_record(
            at, end if framed else self._size
        )
        self.reason = reason
        return resume or ((end, False) if framed else None)

    def _find_overrun_chunk(self, at: int) -> tuple[int, bool] | None:
        """Return the chunk that starts inside the last records, which were misread."""
        if not self.before:
            return None
        chunk = self._find_valid_record(self.before[0], at, only_chunks=True)
        while self.before and (chunk is None or self.before[-1] >= chunk[0]):
            self.before.pop()  # the remaining ones precede the chunk
        while chunk is not None and len(self.before) > 1:
            self.before.popleft()  # only the last one overlaps it
        return chunk

    def _find_valid_record(
        self, start: int, stop: int, only_chunks: bool = False
    ) -> tuple[int, bool] | None:
        """Return the offset of a valid record before `stop`, and if it must be a chunk."""
        if not self._may_continue_search(A_SEARCH):
            return None
        for at, chunk in find_candidate_offsets(self._read, start, stop, self._size):
            opcode, length = self.read_record_header(at)
            if (
                (chunk or at == start)
                and self._may_continue_search(A_CHUNK)
                and self._read_chunk(at, length) is not None
            ):
                return at, True
            end = at + RECORD.size + length
            if (
                only_chunks
                or at == start
                or end > self._size
                or not self._is_possible_record_start(end)
            ):
                continue
            if opcode == Opcode.MESSAGE and not self._chunked:
                return at, False
            if (
                opcode in SHAPES
                and self._may_continue_search(length)
                and self.read_record(at) is not None
            ):
                return at, False
        return None

    def _may_continue_search(self, cost: int) -> bool:
        """Return whether the search may go on; hostile files could make it endless."""
        self._effort -= cost
        return self._effort > 0
