"""
The long way to a file's contents: every record from the front.

For recordings without a summary: the recorder was killed, the file was cut, or another program
wrote it so. Whatever is whole before the first cut record counts; a chunk whose CRC does not
hold is left out.
"""

from typing import BinaryIO, final

from lta_analysis.bag.chunks import Damaged, MESSAGE, RECORD, records, unpacked
from lta_analysis.bag.contents import Contents, Place, read_at
from lta_bridge.bag.records import MAGIC
from mcap.opcode import Opcode

LONGEST_RUN = 1 << 20  # Bare messages are read in stretches of about this many bytes.


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
    scanner = Scanner(stream)
    at = len(MAGIC)
    while at + RECORD.size <= size:
        opcode, length = RECORD.unpack(read_at(stream, at, RECORD.size))
        end = at + RECORD.size + length
        if opcode == 0 or end > size:
            break
        scanner.take(opcode, at, length)
        at = end
        if opcode == Opcode.FOOTER:
            break
    stream.seek(at)
    if stream.read(len(MAGIC)) != MAGIC:
        scanner.contents.losses.append(unfinished(at, size))
    return scanner.contents


def unfinished(end: int, size: int) -> str:
    """Return the sentence about a file whose last whole record ends before it should."""
    if end == size:
        return 'The recording was not finished: it ends without a summary.'
    return (
        f'The recording was not finished: the last {size - end} of {size} bytes are not a whole '
        'record.'
    )


@final
class Scanner:
    """Collects the contents record by record."""

    def __init__(self, stream: BinaryIO) -> None:
        self.contents = Contents()
        self._stream = stream

    def take(self, opcode: int, offset: int, length: int) -> None:
        """Take note of one whole record of the file."""
        try:
            if opcode == Opcode.CHUNK:
                self._take_chunk(offset, length)
            elif opcode == Opcode.MESSAGE:
                self._take_message(offset, length)
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA):
                body = read_at(self._stream, offset + RECORD.size, length)
                self.contents.add(opcode, body)
        except Damaged:
            self.contents.losses.append(damage(offset, RECORD.size + length))

    def _take_chunk(self, offset: int, length: int) -> None:
        """Take note of a chunk, of its messages and of what is announced in it."""
        data = unpacked(read_at(self._stream, offset + RECORD.size, length))
        found = list(records(data))
        channels = set()
        for record in found:
            if record.opcode == Opcode.MESSAGE and record.end - record.start >= MESSAGE.size:
                channel, _, log_time, _ = MESSAGE.unpack_from(data, record.start)
                self.contents.count(channel, log_time)
                channels.add(channel)
            else:
                self.contents.add(record.opcode, data[record.start : record.end])
        self.contents.places.append(Place(offset, RECORD.size + length, True, frozenset(channels)))

    def _take_message(self, offset: int, length: int) -> None:
        """Take note of a message outside chunks, in one stretch with its neighbours."""
        if length < MESSAGE.size:
            raise Damaged
        head = read_at(self._stream, offset + RECORD.size, MESSAGE.size)
        channel, _, log_time, _ = MESSAGE.unpack(head)
        self.contents.count(channel, log_time)
        run = Place(offset, 0, False, None)
        places = self.contents.places
        if places and extends(places[-1], offset):
            run = places.pop()
        places.append(run._replace(length=run.length + RECORD.size + length))


def extends(run: Place, offset: int) -> bool:
    """Tell whether a message at `offset` belongs to a stretch of bare messages."""
    return not run.packed and run.offset + run.length == offset and run.length < LONGEST_RUN


def damage(offset: int, length: int) -> str:
    """Return the sentence about a record that cannot be used."""
    return f'The {length} bytes from byte {offset} on are damaged; what they held is left out.'
