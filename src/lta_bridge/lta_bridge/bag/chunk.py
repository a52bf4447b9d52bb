"""Build MCAP chunks: messages of all topics, compressed and indexed together."""

from collections import defaultdict
from dataclasses import dataclass
import struct
from typing import final
import zlib

from lta_bridge.bag.records import encode_records
from mcap.opcode import Opcode
from mcap.records import Chunk, ChunkIndex
import zstandard

MESSAGE = struct.Struct('<BQHIQQ')  # opcode, length, channel, sequence, log time, publish time
INDEX_HEAD = struct.Struct('<BQHI')  # opcode, length, channel, bytes of entries
INDEX_ENTRY = struct.Struct('<QQ')  # log time, offset in the chunk
# The two sizes count from behind the opcode and the length field, as MCAP's record length does.
MESSAGE_HEAD = 22  # bytes of a message record before its data
ENTRIES_HEAD = 6  # bytes of an index record before its entries


@final
@dataclass(frozen=True, slots=True)
class FinishedChunk:
    """A chunk ready for the file: its bytes, index record and message counts by channel."""

    data: bytes
    index: ChunkIndex
    counts: dict[int, int]


@final
class ChunkBuilder:
    """Collect messages for the next chunk."""

    def __init__(self) -> None:
        # The fastest level: a recorder must not slow down the flight
        self._compressor = zstandard.ZstdCompressor(level=1)
        self._records = bytearray()
        self._entries: defaultdict[int, bytearray] = defaultdict(bytearray)
        self._start = 0
        self._end = 0

    @property
    def size(self) -> int:
        """Uncompressed size of the collected messages. [bytes]"""
        return len(self._records)

    @property
    def message_count(self) -> int:
        """Number of collected messages."""
        return sum(len(index) for index in self._entries.values()) // INDEX_ENTRY.size

    def add(
        self,
        channel: int,
        sequence: int,
        log_time: int,
        data: bytes,
        publish_time: int | None = None,
    ) -> None:
        """Add one message; the publish time defaults to the log time."""
        offset = len(self._records)
        if offset == 0:
            self._start = self._end = log_time
        elif log_time > self._end:
            self._end = log_time
        elif log_time < self._start:
            self._start = log_time
        self._records += MESSAGE.pack(
            Opcode.MESSAGE,
            MESSAGE_HEAD + len(data),
            channel,
            sequence,
            log_time,
            log_time if publish_time is None else publish_time,
        )
        self._records += data
        self._entries[channel] += INDEX_ENTRY.pack(log_time, offset)

    def build_chunk(self, offset: int) -> FinishedChunk:
        """Return the messages as a chunk for a byte offset in a file, and start a new one."""
        records = bytes(self._records)
        packed = self._compressor.compress(records)
        chunk = encode_records(
            [Chunk('zstd', packed, self._end, self._start, zlib.crc32(records), len(records))]
        )
        places, indexes, counts = {}, b'', {}
        for channel, entries in self._entries.items():
            # MCAP places the message indexes directly behind their chunk
            places[channel] = offset + len(chunk) + len(indexes)
            inside = ENTRIES_HEAD + len(entries)
            indexes += INDEX_HEAD.pack(Opcode.MESSAGE_INDEX, inside, channel, len(entries))
            indexes += entries
            counts[channel] = len(entries) // INDEX_ENTRY.size
        index = ChunkIndex(
            chunk_length=len(chunk),
            chunk_start_offset=offset,
            compression='zstd',
            compressed_size=len(packed),
            message_end_time=self._end,
            message_index_length=len(indexes),
            message_index_offsets=places,
            message_start_time=self._start,
            uncompressed_size=len(records),
        )
        self._records = bytearray()
        self._entries = defaultdict(bytearray)
        return FinishedChunk(chunk + indexes, index, counts)
