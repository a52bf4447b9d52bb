"""The quick way to a file's contents: the summary that a finished recording ends with."""

from io import BytesIO
import struct
from typing import BinaryIO
import zlib

from lta_analysis.bag.chunks import Damaged, RECORD, records
from lta_analysis.bag.contents import Contents, Place, read_at
from lta_bridge.bag.records import MAGIC
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import ChunkIndex, MetadataIndex, Statistics

FOOTER = struct.Struct('<BQQQI')  # opcode, length, summary, summary offsets, CRC
TAIL = FOOTER.size + len(MAGIC)


def read_summary(stream: BinaryIO, size: int) -> Contents | None:
    """
    Return the contents by a file's summary; None if there is none to rely on.

    Parameters
    ----------
    stream : BinaryIO
        The file.
    size : int
        Its size. [bytes]

    """
    try:
        section = summary_section(stream, size)
        return from_section(stream, section)
    except (Damaged, struct.error, McapError):
        return None


def summary_section(stream: BinaryIO, size: int) -> bytes:
    """Return the bytes between data and footer; Damaged if they are not whole."""
    if size < TAIL:
        raise Damaged
    tail = read_at(stream, size - TAIL, TAIL)
    opcode, _, start, _, crc = FOOTER.unpack_from(tail)
    if opcode != Opcode.FOOTER or not tail.endswith(MAGIC) or not 0 < start <= size - TAIL:
        raise Damaged
    section = read_at(stream, start, size - TAIL - start)
    if crc and crc != zlib.crc32(section + tail[: FOOTER.size - 4]):
        raise Damaged
    return section


def from_section(stream: BinaryIO, section: bytes) -> Contents:
    """Return the contents that a summary section tells; Damaged if it does not tell all."""
    contents = Contents()
    statistics = None
    for record in records(section):
        body = section[record.start : record.end]
        reader = ReadDataStream(BytesIO(body))
        if record.opcode == Opcode.STATISTICS:
            statistics = Statistics.read(reader)
        elif record.opcode == Opcode.CHUNK_INDEX:
            contents.places.append(place(ChunkIndex.read(reader)))
        elif record.opcode == Opcode.METADATA_INDEX:
            index = MetadataIndex.read(reader)
            data = read_at(stream, index.offset, index.length)
            contents.add(data[0], data[RECORD.size :])
        else:
            contents.add(record.opcode, body)
    if statistics is None or not covers(contents, statistics):
        raise Damaged
    contents.counts.update(statistics.channel_message_counts)
    if statistics.message_count:
        contents.widen(statistics.message_start_time, statistics.message_end_time)
    return contents


def place(index: ChunkIndex) -> Place:
    """Return where a chunk is and what it holds."""
    channels = frozenset(index.message_index_offsets) or None
    return Place(index.chunk_start_offset, index.chunk_length, True, channels)


def covers(contents: Contents, statistics: Statistics) -> bool:
    """Tell whether every message that is counted can be found through the summary."""
    return (
        len(contents.channels) == statistics.channel_count
        and len(contents.places) == statistics.chunk_count
        and (bool(contents.places) or statistics.message_count == 0)
    )
