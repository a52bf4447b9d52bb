"""
The long way to a file's contents: every record from the front.

For recordings without a summary: the recorder was killed, the file was cut, or another program
wrote it so. A chunk counts if its CRC holds; where a record does not hold what it should, the
reading goes on at the next one that does.
"""

from collections import deque
from contextlib import suppress
from dataclasses import replace
from typing import BinaryIO, final, NamedTuple

from lta_analysis.bag.chunks import MESSAGE, Read, RECORD, records, sealed
from lta_analysis.bag.contents import Contents, LARGEST_NOTE, Loss, Place
from lta_analysis.bag.packing import Damaged
from lta_analysis.bag.resync import candidates, chunk_like, HEADS
from lta_analysis.bag.rhythm import entries
from lta_analysis.bag.shape import plausible, SHAPES, well_formed
from lta_bridge.bag.records import MAGIC
from mcap.opcode import Opcode
import numpy as np

PRIVATE = 0x80  # Opcodes from here on are anybody's; MCAP defines none beyond DATA_END.
LONGEST_RUN = 1 << 20  # Bare messages are read in stretches of about this many bytes.
ENOUGH = 1 << 26  # Bytes looked at in vain in one file, beyond eight times its size.
A_SEARCH = 20_000  # What a search costs at least, in bytes looked at; likewise
A_CHUNK = 1 << 20  # what a try to unpack costs.
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


class Found(NamedTuple):
    """A record that holds: its opcode, where it ends, and its body or what a chunk unpacks to."""

    opcode: int
    end: int
    body: bytes | memoryview


@final
class Scanner:
    """Collects the contents record by record."""

    def __init__(self, read: Read, size: int) -> None:
        self.contents = Contents()
        self._read = read
        self._size = size
        self._effort = 8 * size + ENOUGH
        self._before: deque[int] = deque(maxlen=4)  # The last records without a CRC.
        self._ended = False  # The data are over; what follows repeats parts of them.
        self._chunked = False  # Messages come in chunks.
        self._doubt = False  # A bare message may come from inside a damaged chunk.
        self._orphan: Loss | None = None  # The loss whose message indexes may follow.
        self._pending: list[tuple[int, int]] = []  # Time and channel of bare messages.
        self._reason = ''  # Why the last chunk cannot be used, if not for damage.

    def walk(self) -> None:
        """Read the file to its end."""
        at, chunk, finished = len(MAGIC), False, False
        while at + RECORD.size <= self._size and not finished:
            found = self._record(at, chunk)
            if found is None:
                following = self._following(at)
                if following is None:
                    break
                self._lose(min([at, *self._before]), following[0])
                self._before.clear()
                at, chunk = following
            else:
                self._take(at, found)
                if found.opcode == Opcode.CHUNK:
                    self._before.clear()
                else:
                    self._before.append(at)
                at, chunk = found.end, False
                finished = found.opcode == Opcode.FOOTER
        self._feed()
        if not finished or self._read(at, len(MAGIC)) != MAGIC:
            self._cut(at)
        more = len(self.contents.lost) - MOST_TOLD
        if more > 0:
            self.contents.losses.append(f'{more} more stretches of the file are damaged.')

    def _record(self, at: int, chunk: bool = False) -> Found | None:
        """Return the record that begins at a place if it holds; `chunk` where it must be one."""
        opcode, length = self._head(at)
        end = at + RECORD.size + length
        if opcode == Opcode.CHUNK or chunk:
            return self._chunk(at, length)
        if opcode == 0 or Opcode.DATA_END < opcode < PRIVATE or end > self._size:
            return None
        if opcode in SHAPES:
            body = self._read(at + RECORD.size, min(length, LARGEST_NOTE + 1))
            holds = well_formed(opcode, body) and not self._swallows(at, end)
            return Found(opcode, end, body) if holds else None
        return self._unsealed(at, opcode, end)

    def _head(self, at: int) -> tuple[int, int]:
        """Return opcode and length of the record at a place; 0 behind the file's end."""
        opcode, length = RECORD.unpack(self._read(at, RECORD.size).ljust(RECORD.size, b'\0'))
        return opcode, length

    def _chunk(self, at: int, length: int) -> Found | None:
        """Return a chunk whose CRC holds."""
        start = at + RECORD.size
        try:
            data, used = sealed(lambda offset, count: self._read(start + offset, count), length)
        except Damaged as error:
            self._reason = str(error)
            return None
        return Found(Opcode.CHUNK, min(start + used, self._size), data)

    def _unsealed(self, at: int, opcode: int, end: int) -> Found | None:
        """Return a record that only what follows confirms: a bare message, an attachment."""
        head = self._read(at, HEADS)
        length = end - at - RECORD.size
        body = head[RECORD.size : RECORD.size + MESSAGE.size]
        if opcode == Opcode.MESSAGE and (
            length < MESSAGE.size or not self._trusted(at, body, end)
        ):
            return None
        if chunk_like(head, length):
            return None  # a chunk with a wrong opcode, which the search finds if its CRC holds
        return None if self._swallows(at, end) else Found(opcode, end, body)

    def _swallows(self, at: int, end: int) -> bool:
        """Tell whether a record is too long: none begins where it ends, but one does before."""
        return not self._begins(end) and self._search(at, end) is not None

    def _trusted(self, at: int, body: bytes, end: int) -> bool:
        """Tell whether a bare message is one, in a file whose messages come in chunks."""
        if self._doubt:
            return False
        if not self._chunked:
            return True
        channel = MESSAGE.unpack(body)[0]
        index = end - at < LARGEST_NOTE and well_formed(
            Opcode.MESSAGE_INDEX, self._read(at + RECORD.size, end - at - RECORD.size)
        )
        return channel in self.contents.channels and not index

    def _begins(self, at: int) -> bool:
        """Tell whether a record can begin at a place, or the file ends there."""
        if self._size - at < RECORD.size:
            return True
        opcode, length = self._head(at)
        return plausible(opcode, length) or opcode >= PRIVATE

    def _following(self, at: int) -> tuple[int, bool] | None:
        """Return where to go on behind a record that does not hold, and if it must be a chunk."""
        opcode, length = self._head(at)
        end = at + RECORD.size + length
        framed = opcode == Opcode.CHUNK and end < self._size and self._begins(end)
        self._chunked |= opcode == Opcode.CHUNK
        self._doubt = self._chunked
        found = self._swallowed(at) or self._search(at, end if framed else self._size)
        return found or ((end, False) if framed else None)

    def _swallowed(self, at: int) -> tuple[int, bool] | None:
        """Return the chunk that begins in what was taken for other records just before."""
        if not self._before:
            return None
        found = self._search(self._before[0], at, only_chunks=True)
        while self._before and (found is None or self._before[-1] >= found[0]):
            self._before.pop()  # what is left stands before the chunk
        while found is not None and len(self._before) > 1:
            self._before.popleft()  # only the last of them reaches into it
        return found

    def _search(self, start: int, stop: int, only_chunks: bool = False) -> tuple[int, bool] | None:
        """Return where before `stop` another record holds, and if it must be a chunk."""
        if not self._affordable(A_SEARCH):
            return None
        for at, chunk in candidates(self._read, start, stop, self._size):
            opcode, length = self._head(at)
            if (
                (chunk or at == start)
                and self._affordable(A_CHUNK)
                and self._chunk(at, length) is not None
            ):
                return at, True
            end = at + RECORD.size + length
            if only_chunks or at == start or end > self._size or not self._begins(end):
                continue
            if opcode == Opcode.MESSAGE and not self._chunked:
                return at, False
            if opcode in SHAPES and self._affordable(length) and self._record(at) is not None:
                return at, False
        return None

    def _affordable(self, cost: int) -> bool:
        """Tell whether so many bytes more are worth a look: hostile files make looking endless."""
        self._effort -= cost
        return self._effort > 0

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
        self._chunked, self._doubt, self._orphan = True, False, None
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
        chunks = int(self._head(at)[0] == Opcode.CHUNK)
        self._orphan = Loss(at, end - at, chunks)
        self.contents.lost.append(self._orphan)
        if len(self.contents.lost) <= MOST_TOLD:
            self.contents.losses.append(damage(at, end - at, self._reason if chunks else ''))

    def _cut(self, at: int) -> None:
        """Take note of an end that is none."""
        self.contents.losses.append(unfinished(at, self._size))
        if at < self._size and not self._ended:
            chunks = int(self._head(at)[0] == Opcode.CHUNK)
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
