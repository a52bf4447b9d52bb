"""Read the contents of a finished MCAP file from its summary."""

from collections import deque
from io import BytesIO
import struct
from typing import BinaryIO
import zlib

from lta_config.limits import NOTE_BYTES, SUMMARY_BYTES
from lta_data.bag.mcap_file.chunks import DamagedRecord, iterate_records, RECORD
from lta_data.bag.mcap_file.contents import McapContents, MessageRegion, read_at
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import MetadataIndex, Statistics
from mcap.writer import MCAP0_MAGIC

FOOTER = struct.Struct('<BQQQI')  # opcode, length, summary, summary offsets, CRC
TAIL = FOOTER.size + len(MCAP0_MAGIC)
CHUNK_INDEX = struct.Struct('<QQQQI')  # start, end, offset, length, bytes of the channels
CHANNEL = struct.Struct('<HQ')  # channel, offset of its message index
UNUSABLE = (
    'The summary at the end of the file is damaged; the file is scanned from its start instead.'
)


def read_summary(stream: BinaryIO, size: int) -> McapContents | None:
    """Return the contents from a file's summary; None without a valid one."""
    try:
        start, section = read_summary_section(stream, size)
        return parse_summary(stream, start, section)
    except (DamagedRecord, struct.error, UnicodeDecodeError, McapError):
        return None


def summary_is_damaged(stream: BinaryIO, size: int) -> bool:
    """Return whether a file ends like a finished one but with a damaged summary."""
    if size < TAIL:
        return False
    tail = read_at(stream, size - TAIL, TAIL)
    opcode, _, start, _, _ = FOOTER.unpack_from(tail)
    if opcode != Opcode.FOOTER or not tail.endswith(MCAP0_MAGIC) or start == 0:
        return False
    try:
        _, section = read_summary_section(stream, size)
        deque(iterate_records(section), maxlen=0)
    except DamagedRecord:
        return True
    return False


def read_summary_section(stream: BinaryIO, size: int) -> tuple[int, bytes]:
    """Return offset and bytes of the summary section; raise DamagedRecord if it is incomplete."""
    if size < TAIL:
        raise DamagedRecord
    tail = read_at(stream, size - TAIL, TAIL)
    opcode, _, start, _, crc = FOOTER.unpack_from(tail)
    if opcode != Opcode.FOOTER or not tail.endswith(MCAP0_MAGIC) or not 0 < start <= size - TAIL:
        raise DamagedRecord
    if size - TAIL - start > SUMMARY_BYTES:
        raise DamagedRecord
    section = read_at(stream, start, size - TAIL - start)
    # CRC 0 means not computed. It covers the footer up to the CRC itself.
    if crc and crc != zlib.crc32(section + tail[: FOOTER.size - 4]):
        raise DamagedRecord
    return start, section


def parse_summary(stream: BinaryIO, start: int, section: bytes) -> McapContents:
    """Return the contents in a summary section; raise DamagedRecord if it is inconsistent."""
    contents = McapContents(indexed=True)
    statistics = None
    notes = []
    for record in iterate_records(section):
        body = section[record.start : record.end]
        if record.opcode == Opcode.CHUNK_INDEX:
            contents.places.append(parse_chunk_region(body))
        elif record.opcode == Opcode.STATISTICS:
            statistics = Statistics.read(ReadDataStream(BytesIO(body)))
        elif record.opcode == Opcode.METADATA_INDEX:
            notes.append(MetadataIndex.read(ReadDataStream(BytesIO(body))))
        else:
            contents.add_record(record.opcode, body)
    if statistics is None or not covers_all_messages(contents, statistics, start):
        raise DamagedRecord
    for note in notes:
        add_metadata(stream, contents, note)
    contents.counts.update(statistics.channel_message_counts)
    if statistics.message_count:
        contents.extend_time_span(statistics.message_start_time, statistics.message_end_time)
    return contents


def add_metadata(stream: BinaryIO, contents: McapContents, note: MetadataIndex) -> None:
    """Add a metadata record, or a remark if it is damaged."""
    try:
        if note.length > NOTE_BYTES:
            raise DamagedRecord
        data = read_at(stream, note.offset, note.length)
        opcode, length = RECORD.unpack_from(data)
        if opcode != Opcode.METADATA or length != len(data) - RECORD.size:
            raise DamagedRecord
        contents.add_record(opcode, data[RECORD.size :])
    except (DamagedRecord, struct.error):
        contents.remarks.append(f"The metadata record '{note.name}' is damaged and left out.")


def parse_chunk_region(body: bytes) -> MessageRegion:
    """Return the region of a chunk."""
    start, end, offset, length, size = CHUNK_INDEX.unpack_from(body)
    stop = CHUNK_INDEX.size + size
    if size % CHANNEL.size or stop + 8 > len(body):
        raise DamagedRecord
    channels = frozenset(id for id, _ in CHANNEL.iter_unpack(body[CHUNK_INDEX.size : stop]))
    return MessageRegion(offset, length, True, channels or None, start, end)


def covers_all_messages(contents: McapContents, statistics: Statistics, data_end: int) -> bool:
    """Return whether the summary leads to every counted message exactly once."""
    after = len(MCAP0_MAGIC)
    for region in sorted(contents.places, key=lambda place: place.offset):
        if region.offset < after:
            return False
        after = region.offset + region.length
    return (
        after <= data_end
        and all(c.schema_id in contents.schemas for c in contents.channels.values() if c.schema_id)
        and len(contents.channels) == statistics.channel_count
        and len(contents.places) == statistics.chunk_count
        and (bool(contents.places) or statistics.message_count == 0)
    )
