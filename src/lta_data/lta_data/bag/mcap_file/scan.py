"""
The long way to a file's contents: every record from the front.

For recordings without a summary: the recorder was killed, the file was cut, or another program
wrote it so. A chunk counts if its CRC holds; where a record does not hold what it should, the
reading goes on at the next one that does.
"""

from contextlib import suppress
from dataclasses import replace
from typing import BinaryIO, final

from lta_bridge.bag.records import MAGIC
from lta_data.bag.mcap_file.chunks import MESSAGE, Read, RECORD, records
from lta_data.bag.mcap_file.contents import Contents, Loss, Place
from lta_data.bag.mcap_file.holding import Found, Prober
from lta_data.bag.mcap_file.packing import Damaged
from lta_data.bag.mcap_file.rhythm import entries
from mcap.opcode import Opcode
import numpy as np

LONGEST_RUN = 1 << 20  # Bare messages are read in stretches of about this many bytes.
MANY_PENDING = 10_000
MOST_TOLD = 100  # Losses beyond are only counted.


def scan(stream: BinaryIO, size: int) -> Contents:
    """
    Return the contents of a file that starts as MCAP.

    Parameters
    ----------
    stream : BinaryIO
        The file.
    size : int
        Its size. [bytes]

    """

    def read(offset: int, length: int) -> bytes:
        stream.seek(offset)
        return stream.read(max(0, min(length, size - offset)))

    scanner = Scanner(read, size)
    scanner.walk()
    return scanner.contents


@final
class Scanner:
    """Collects the contents record by record."""

    def __init__(self, read: Read, size: int) -> None:
        self.contents = Contents()
        self._read = read
        self._size = size
        self._prober = Prober(read, size, self.contents.channels)
        self._ended = False  # The data are over; what follows repeats parts of them.
        self._orphan: Loss | None = None  # The loss whose message indexes may follow.
        self._pending: list[tuple[int, int]] = []  # Time and channel of bare messages.

    def walk(self) -> None:
        """Read the file to its end."""
        at, chunk, finished = len(MAGIC), False, False
        while at + RECORD.size <= self._size and not finished:
            found = self._prober.record(at, chunk)
            if found is None:
                following = self._prober.following(at)
                if following is None:
                    break
                self._lose(min([at, *self._prober.before]), following[0])
                self._prober.before.clear()
                at, chunk = following
            else:
                self._take(at, found)
                self._prober.took(at, found)
                at, chunk = found.end, False
                finished = found.opcode == Opcode.FOOTER
        self._feed()
        if not finished or self._read(at, len(MAGIC)) != MAGIC:
            self._cut(at)
        more = len(self.contents.lost) - MOST_TOLD
        if more > 0:
            self.contents.losses.append(f'{more} more stretches of the file are damaged.')

    def _take(self, at: int, found: Found) -> None:
        """Take note of a record that holds."""
        if found.opcode == Opcode.CHUNK:
            self._take_chunk(at, found)
        elif found.opcode == Opcode.MESSAGE:
            self._take_message(at, found)
        elif found.opcode == Opcode.MESSAGE_INDEX:
            self._take_index(at, found)
        elif found.opcode == Opcode.DATA_END:
            self._ended = True
        else:
            with suppress(Damaged):  # which `well_formed` has ruled out
                self.contents.add(found.opcode, bytes(found.body))

    def _take_chunk(self, at: int, found: Found) -> None:
        """Take note of a chunk, of its messages and of what is announced in it."""
        self._orphan = None
        times, channels = [], []
        contents = self.contents
        try:
            for record in records(found.body):
                if record.opcode == Opcode.MESSAGE and record.end - record.start >= MESSAGE.size:
                    channel, _, log_time, _ = MESSAGE.unpack_from(found.body, record.start)
                    times.append(log_time)
                    channels.append(channel)
                elif record.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                    contents.add(record.opcode, bytes(found.body[record.start : record.end]))
        except Damaged:
            contents.losses.append(damage(at, found.end - at))
        self._feed()
        contents.counts.update(channels)
        first, last = min(times, default=None), max(times, default=None)
        if first is not None and last is not None:
            contents.widen(first, last)
        contents.rhythm.feed(np.array(times, np.uint64), np.array(channels, np.uint16))
        known = frozenset(channels)
        contents.places.append(Place(at, found.end - at, True, known, first, last))

    def _take_message(self, at: int, found: Found) -> None:
        """Take note of a message outside chunks, in one stretch with its neighbours."""
        channel, _, log_time, _ = MESSAGE.unpack(found.body)
        self.contents.count(channel, log_time)
        self._pending.append((log_time, channel))
        if len(self._pending) >= MANY_PENDING:
            self._feed()
        run = Place(at, 0, False, None, log_time, log_time)
        places = self.contents.places
        if places and extends(places[-1], at):
            run = places.pop()
        places.append(
            replace(
                run,
                length=found.end - run.offset,
                start=min(run.start or 0, log_time),
                end=max(run.end or 0, log_time),
            )
        )

    def _feed(self) -> None:
        """Take note of when bare messages were recorded."""
        if self._pending:
            times, channels = zip(*self._pending, strict=True)
            self.contents.rhythm.feed(np.array(times, np.uint64), np.array(channels, np.uint16))
            self._pending.clear()

    def _take_index(self, at: int, found: Found) -> None:
        """Take note of a message index: of the chunk before it, or of one that is lost."""
        if self._orphan is not None:
            for channel, listed in entries(self._read(at, found.end - at)):
                self._orphan.counts[channel] += len(listed)
                if len(listed):
                    times = listed['time']
                    self._orphan.widen(int(times.min()), int(times.max()))

    def _lose(self, at: int, end: int) -> None:
        """Take note of a stretch that does not hold what it should."""
        if self._ended or end <= at:
            return
        chunks = int(self._prober.head(at)[0] == Opcode.CHUNK)
        self._orphan = Loss(at, end - at, chunks)
        self.contents.lost.append(self._orphan)
        if len(self.contents.lost) <= MOST_TOLD:
            self.contents.losses.append(
                damage(at, end - at, self._prober.reason if chunks else '')
            )

    def _cut(self, at: int) -> None:
        """Take note of an end that is none."""
        self.contents.losses.append(unfinished(at, self._size))
        if at < self._size and not self._ended:
            chunks = int(self._prober.head(at)[0] == Opcode.CHUNK)
            self.contents.lost.append(Loss(at, self._size - at, chunks))


def unfinished(end: int, size: int) -> str:
    """Return the sentence about a file whose last whole record ends before it should."""
    if end == size:
        return 'The recording was not finished: it ends without a summary.'
    return (
        f'The recording was not finished: the last {size - end} of {size} bytes are not a whole '
        'record.'
    )


def extends(run: Place, offset: int) -> bool:
    """Tell whether a message at `offset` belongs to a stretch of bare messages."""
    return not run.packed and run.offset + run.length == offset and run.length < LONGEST_RUN


def damage(offset: int, length: int, reason: str = '') -> str:
    """Return the sentence about a stretch that cannot be used; `reason` is a half-sentence."""
    return (
        f'The {length} bytes from byte {offset} on {reason or "are damaged"}; what they held is '
        'left out.'
    )
