"""
Scan an MCAP file record by record.

This is for recordings without a valid summary: the recorder was killed, the file was cut, or
another program wrote it without one. A chunk counts if its CRC is right; after an invalid record,
the scan continues at the next valid one.
"""

from contextlib import suppress
from dataclasses import replace
from typing import BinaryIO, final

from lta_bridge.bag.records import MAGIC
from lta_data.bag.mcap_file.chunks import iterate_records, MESSAGE, Read, RECORD
from lta_data.bag.mcap_file.compression import DamagedRecord
from lta_data.bag.mcap_file.contents import DamagedRegion, McapContents, MessageRegion
from lta_data.bag.mcap_file.record_prober import RecordProber, ValidRecord
from lta_data.bag.mcap_file.rhythm import iterate_index_entries
from mcap.opcode import Opcode
import numpy as np

LONGEST_RUN = 1 << 20  # bytes; bare messages are read in regions of about this size
MANY_PENDING = 10_000  # bare messages held before they enter the rhythm
MOST_TOLD = 100  # further losses are only counted


def scan_mcap_file(stream: BinaryIO, size: int) -> McapContents:
    """Return the contents of a file that starts as MCAP; `size` in bytes."""

    def read(offset: int, length: int) -> bytes:
        stream.seek(offset)
        return stream.read(max(0, min(length, size - offset)))

    scanner = McapScanner(read, size)
    scanner.walk()
    return scanner.contents


@final
class McapScanner:
    """Collects the contents record by record."""

    def __init__(self, read: Read, size: int) -> None:
        self.contents = McapContents()
        self._read = read
        self._size = size
        self._prober = RecordProber(read, size, self.contents.channels)
        self._ended = False  # the data section is over; the rest repeats parts of it
        self._orphan: DamagedRegion | None = None  # the loss whose message indexes may follow
        self._pending: list[tuple[int, int]] = []  # time and channel of bare messages

    def walk(self) -> None:
        """Scan the file to its end."""
        at, chunk, finished = len(MAGIC), False, False
        while at + RECORD.size <= self._size and not finished:
            record = self._prober.read_record(at, chunk)
            if record is None:
                following = self._prober.find_resume_offset(at)
                if following is None:
                    break
                self._note_loss(min([at, *self._prober.before]), following[0])
                self._prober.before.clear()
                at, chunk = following
            else:
                self._add_record(at, record)
                self._prober.accept_record(at, record)
                at, chunk = record.end, False
                finished = record.opcode == Opcode.FOOTER
        self._flush_pending()
        if not finished or self._read(at, len(MAGIC)) != MAGIC:
            self._note_truncation(at)
        more = len(self.contents.lost) - MOST_TOLD
        if more > 0:
            self.contents.losses.append(
                f'{more} more regions of the file are damaged and not listed.'
            )

    def _add_record(self, at: int, record: ValidRecord) -> None:
        if record.opcode == Opcode.CHUNK:
            self._add_chunk(at, record)
        elif record.opcode == Opcode.MESSAGE:
            self._add_message(at, record)
        elif record.opcode == Opcode.MESSAGE_INDEX:
            self._count_lost_messages(at, record)
        elif record.opcode == Opcode.DATA_END:
            self._ended = True
        else:
            with suppress(DamagedRecord):  # cannot happen after `is_well_formed`
                self.contents.add_record(record.opcode, bytes(record.body))

    def _add_chunk(self, at: int, chunk: ValidRecord) -> None:
        """Add a chunk, its messages and the channels announced in it."""
        self._orphan = None
        times, channels = [], []
        contents = self.contents
        try:
            for record in iterate_records(chunk.body):
                if record.opcode == Opcode.MESSAGE and record.end - record.start >= MESSAGE.size:
                    channel, _, log_time, _ = MESSAGE.unpack_from(chunk.body, record.start)
                    times.append(log_time)
                    channels.append(channel)
                elif record.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                    contents.add_record(
                        record.opcode, bytes(chunk.body[record.start : record.end])
                    )
        except DamagedRecord:
            contents.losses.append(describe_damage(at, chunk.end - at))
        self._flush_pending()
        contents.counts.update(channels)
        first, last = min(times, default=None), max(times, default=None)
        if first is not None and last is not None:
            contents.extend_time_span(first, last)
        contents.rhythm.add_times(np.array(times, np.uint64), np.array(channels, np.uint16))
        channel_ids = frozenset(channels)
        contents.places.append(MessageRegion(at, chunk.end - at, True, channel_ids, first, last))

    def _add_message(self, at: int, record: ValidRecord) -> None:
        """Add a message outside chunks to the region of its neighbours."""
        channel, _, log_time, _ = MESSAGE.unpack(record.body)
        self.contents.count_message(channel, log_time)
        self._pending.append((log_time, channel))
        if len(self._pending) >= MANY_PENDING:
            self._flush_pending()
        run = MessageRegion(at, 0, False, None, log_time, log_time)
        places = self.contents.places
        if places and extends_run(places[-1], at):
            run = places.pop()
        places.append(
            replace(
                run,
                length=record.end - run.offset,
                start=min(run.start or 0, log_time),
                end=max(run.end or 0, log_time),
            )
        )

    def _flush_pending(self) -> None:
        """Add the times of pending bare messages to the rhythm."""
        if self._pending:
            times, channels = zip(*self._pending, strict=True)
            self.contents.rhythm.add_times(
                np.array(times, np.uint64), np.array(channels, np.uint16)
            )
            self._pending.clear()

    def _count_lost_messages(self, at: int, record: ValidRecord) -> None:
        """Count the messages of a lost chunk by its message index."""
        if self._orphan is not None:
            for channel, listed in iterate_index_entries(self._read(at, record.end - at)):
                self._orphan.counts[channel] += len(listed)
                if len(listed):
                    times = listed['time']
                    self._orphan.extend_time_span(int(times.min()), int(times.max()))

    def _note_loss(self, at: int, end: int) -> None:
        """Add an unusable region."""
        # Behind the data end only the summary is damaged, which the scan does not need.
        if self._ended or end <= at:
            return
        chunks = int(self._prober.read_record_header(at)[0] == Opcode.CHUNK)
        self._orphan = DamagedRegion(at, end - at, chunks)
        self.contents.lost.append(self._orphan)
        if len(self.contents.lost) <= MOST_TOLD:
            self.contents.losses.append(
                describe_damage(at, end - at, self._prober.reason if chunks else '')
            )

    def _note_truncation(self, at: int) -> None:
        """Add the loss of a truncated end."""
        self.contents.losses.append(describe_truncation(at, self._size))
        if at < self._size and not self._ended:
            chunks = int(self._prober.read_record_header(at)[0] == Opcode.CHUNK)
            self.contents.lost.append(DamagedRegion(at, self._size - at, chunks))


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
