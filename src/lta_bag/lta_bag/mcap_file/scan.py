# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Scan an MCAP file chunk by chunk.

This is for recordings without a valid summary: the recorder was killed, the disk was full, the
file was cut, or another program wrote it without one. A chunk counts if its CRC is right. What
lies between two such chunks is walked record by record, and given up where that ends.
"""

from contextlib import suppress
from dataclasses import dataclass
import re
from typing import BinaryIO, Final, final, NamedTuple

from lta_bag.mcap_file.chunks import (
    DamagedRecord,
    iterate_records,
    MESSAGE,
    RECORD,
    unpack_chunk,
    unpack_cut_chunk,
)
from lta_bag.mcap_file.contents import McapContents, MessageRegion
from lta_config.limits import CHUNK_BYTES, NOTE_BYTES
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

# A chunk from its length on: length, times, size, CRC, compression, packed length. Lengths and
# sizes are below 4 GB.
CHUNK_LIKE: Final = rb'.{4}\0{4}.{16}.{4}\0{4}.{4}(?:\x04\0{3}zstd|\x03\0{3}lz4|\0{4}).{4}\0{4}'
CHUNK_HEAD: Final = re.compile(rb'\x06' + CHUNK_LIKE, re.DOTALL)
MISLABELLED_CHUNK: Final = re.compile(rb'[^\x06]' + CHUNK_LIKE, re.DOTALL)
HEAD_SIZE = 53  # bytes of the longest such head
FIRST_WINDOW, LARGEST_WINDOW = 1 << 12, 1 << 20  # bytes; the next chunk is usually near
FUTILE = 1 << 26  # bytes of futile attempts to unpack per file, beyond eight times its size
ATTEMPT = 1 << 20  # least cost of an attempt [bytes]
LONGEST_RUN = 1 << 20  # bytes; bare messages are read in regions of about this size
MOST_TOLD = 100  # further losses are only counted
PRIVATE = 0x80  # opcodes from here on are private
DATA_END_SIZE, FOOTER_SIZE = 4, 20  # bytes without opcode and length
UNREAD: Final = (Opcode.HEADER, Opcode.ATTACHMENT, Opcode.MESSAGE_INDEX)
NAMING_OPCODES: Final = (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA)


class IntactChunk(NamedTuple):
    """A chunk with a correct CRC: its region in the file [bytes] and its records."""

    start: int
    end: int
    records: bytes | memoryview


@final
@dataclass(slots=True)
class DamagedRegion:
    """
    A region of the file that cannot be used [bytes from the start of the file].

    `reason`: why, as a clause, if not for damage.
    """

    offset: int
    length: int
    reason: str = ''


def scan_mcap_file(stream: BinaryIO, size: int) -> McapContents:
    """Return the contents of a file that starts as MCAP; `size` in bytes."""
    scanner = McapScanner(stream, size)
    scanner.walk()
    return scanner.contents


@final
class McapScanner:
    """Collects the contents chunk by chunk."""

    def __init__(self, stream: BinaryIO, size: int) -> None:
        self.contents = McapContents()
        self._lost: list[DamagedRegion] = []
        self._stream = stream
        self._size = size
        self._patience = 8 * size + FUTILE
        self._chunked = False  # messages come in chunks
        self._ended = False  # the data section is over; the rest repeats parts of it
        self._finished = False
        self._readable = len(MCAP0_MAGIC)  # end of the last valid record

    def walk(self) -> None:
        """Scan the file to its end."""
        chunk = self._find_chunk(len(MCAP0_MAGIC))
        while chunk is not None:
            self._chunked = True
            self._read_between(self._readable, chunk.start)
            self._add_chunk(chunk)
            chunk = self._find_chunk(chunk.end)
        self._read_between(self._readable, self._size)
        self._describe_losses()

    def _read(self, offset: int, length: int) -> bytes:
        """Return bytes of the file; fewer at its end."""
        self._stream.seek(offset)
        return self._stream.read(max(0, min(length, self._size - offset)))

    def _find_chunk(self, start: int) -> IntactChunk | None:
        """Return the first intact chunk from an offset on."""
        at, width = start, FIRST_WINDOW
        while at < self._size and self._patience > 0:
            window = self._read(at, width + HEAD_SIZE)
            head = CHUNK_HEAD.search(window)
            while head is not None and self._patience > 0:
                with suppress(DamagedRecord):
                    return self._unpack_chunk(at + head.start())
                head = CHUNK_HEAD.search(window, head.start() + 1)
            at += width
            width = min(2 * width, LARGEST_WINDOW)
        return None

    def _read_head(self, at: int) -> tuple[int, int]:
        """Return opcode and length of the record at an offset; 0 beyond the end of the file."""
        opcode, length = RECORD.unpack(self._read(at, RECORD.size).ljust(RECORD.size, b'\0'))
        return opcode, length

    def _unpack_chunk(self, at: int) -> IntactChunk:
        """Return the chunk at an offset; raise DamagedRecord if it is not intact."""
        start = at + RECORD.size
        length = self._read_head(at)[1]
        if start + length > self._size:
            raise DamagedRecord
        if length > 2 * CHUNK_BYTES:
            raise DamagedRecord(
                f'declare a chunk of {length} bytes, more than the limit of {2 * CHUNK_BYTES} '
                'bytes'
            )
        try:
            return IntactChunk(at, start + length, unpack_chunk(self._read(start, length)))
        except DamagedRecord:
            self._patience -= ATTEMPT + length
            raise

    def _read_between(self, at: int, stop: int) -> None:
        """Read the records between two intact chunks, or behind the last one."""
        while at < stop and not self._finished:
            opcode, length = self._read_head(at)
            end = at + RECORD.size + length
            try:
                if end > stop or MISLABELLED_CHUNK.match(self._read(at, HEAD_SIZE)):
                    raise DamagedRecord
                self._add_record(opcode, at, end)
                self._readable = end
            except DamagedRecord as error:
                is_cut = opcode == Opcode.CHUNK and stop == self._size < end
                is_read = is_cut and self._add_cut_chunk(at)
                # The length of a damaged chunk may be right; that of others misleads
                end = end if opcode == Opcode.CHUNK and end <= stop else stop
                if not is_read:
                    self._note_loss(at, end, opcode, str(error))
            at = end

    def _add_record(self, opcode: int, at: int, end: int) -> None:
        """Add a record outside of intact chunks; raise DamagedRecord if it cannot be one."""
        start = at + RECORD.size
        if opcode == Opcode.CHUNK:
            self._add_chunk(self._unpack_chunk(at))
        elif opcode == Opcode.MESSAGE:
            self._add_message(at, end)
        elif opcode == Opcode.DATA_END and end - start == DATA_END_SIZE:
            self._ended = True
        elif opcode == Opcode.FOOTER and end - start == FOOTER_SIZE:
            self._ended = True
            self._finished = self._read(end, self._size - end) == MCAP0_MAGIC
        elif opcode in NAMING_OPCODES and not self._ended:
            if end - start > NOTE_BYTES:
                raise DamagedRecord
            self.contents.add_record(opcode, self._read(start, end - start))
        # The summary is damaged: what it repeats is not believed
        elif not (opcode in UNREAD or opcode >= PRIVATE or self._ended):
            raise DamagedRecord

    def _add_cut_chunk(self, at: int) -> bool:
        """Add the messages of a chunk without its end; return whether any is left."""
        with suppress(DamagedRecord):
            body = self._read(at + RECORD.size, min(self._size - at, 2 * CHUNK_BYTES))
            if records := unpack_cut_chunk(body):
                self._add_chunk(IntactChunk(at, self._size, records), is_cut=True)
                self.contents.losses.append(
                    f'The chunk at byte {at} is cut off; the messages before the cut are read, '
                    'and no checksum covers them.'
                )
                return True
        return False

    def _add_chunk(self, chunk: IntactChunk, *, is_cut: bool = False) -> None:
        """Add a chunk, its messages and the channels announced in it."""
        self._ended, self._readable = False, chunk.end
        times, channels = [], []
        contents = self.contents
        length = chunk.end - chunk.start
        try:
            for record in iterate_records(chunk.records):
                if record.opcode == Opcode.MESSAGE and record.end - record.start >= MESSAGE.size:
                    channel, _, log_time, _ = MESSAGE.unpack_from(chunk.records, record.start)
                    times.append(log_time)
                    channels.append(channel)
                elif record.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                    contents.add_record(
                        record.opcode, bytes(chunk.records[record.start : record.end])
                    )
        except DamagedRecord:
            contents.losses.append(describe_damage(chunk.start, length))
        contents.counts.update(channels)
        if times:
            contents.extend_time_span(min(times), max(times))
        contents.places.append(
            MessageRegion(chunk.start, length, True, frozenset(channels), is_cut)
        )

    def _add_message(self, at: int, end: int) -> None:
        """Add a message outside chunks to the region of its neighbours."""
        if self._chunked or end - at < RECORD.size + MESSAGE.size:
            raise DamagedRecord
        channel, _, log_time, _ = MESSAGE.unpack(self._read(at + RECORD.size, MESSAGE.size))
        if channel not in self.contents.channels:
            raise DamagedRecord
        self.contents.count_message(channel, log_time)
        places = self.contents.places
        start = places.pop().offset if places and extends_run(places[-1], at) else at
        places.append(MessageRegion(start, end - start, False, None))

    def _note_loss(self, at: int, end: int, opcode: int, reason: str) -> None:
        """Add an unusable region, or extend the last one."""
        # Behind the data end only the summary is damaged, which the scan does not need.
        if self._ended:
            return
        is_chunk = opcode == Opcode.CHUNK
        self._chunked |= is_chunk
        lost = self._lost
        if lost and lost[-1].offset + lost[-1].length == at and not is_chunk:
            lost[-1].length += end - at
        else:
            lost.append(DamagedRegion(at, end - at, reason))

    def _describe_losses(self) -> None:
        """Add a sentence for each unusable region, and for an end that is missing."""
        lost, size = self._lost, self._size
        magic = len(MCAP0_MAGIC)
        cut = self._read(max(size - magic, magic), magic) != MCAP0_MAGIC
        for loss in lost[:MOST_TOLD]:
            if not cut or loss.offset + loss.length < size:
                self.contents.losses.append(describe_damage(loss.offset, loss.length, loss.reason))
        if cut:
            at_end = lost and lost[-1].offset + lost[-1].length == size
            self.contents.losses.append(
                describe_truncation(lost[-1].offset if at_end else self._readable, size)
            )
        more = len(lost) - MOST_TOLD
        if more > 0:
            self.contents.losses.append(
                f'{more} more regions of the file are damaged and not listed.'
            )


def describe_truncation(end: int, size: int) -> str:
    """Return the sentence about an unfinished file."""
    if end == size:
        return 'The recording was not finished: it ends without a summary.'
    return (
        f'The recording was not finished: the last {size - end} of {size} bytes are not a '
        'complete record.'
    )


def extends_run(run: MessageRegion, offset: int) -> bool:
    """Return whether a message at `offset` continues a region of bare messages."""
    return not run.packed and run.offset + run.length == offset and run.length < LONGEST_RUN


def describe_damage(offset: int, length: int, reason: str = '') -> str:
    """Return the sentence about an unusable region; `reason` is a clause."""
    return (
        f'The {length} bytes from byte {offset} on {reason or "are damaged"}; their content is '
        'left out.'
    )
