"""
Write an MCAP file whose summary always matches the data on the disk.

Chunks are written whole. Schemas and channels are written outside the chunks, so that a damaged
chunk does not make others unreadable. Format: https://mcap.dev/spec.
"""

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import final
import zlib

from lta_bridge.bag.chunk import ChunkBuilder
from lta_bridge.bag.records import CompressedRecords, encode_records, MAGIC
from lta_bridge.bag.schemas import MessageDefinition
from lta_bridge.bag.storage import RecordFile
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

CHUNK_SIZE = 1 << 20  # bytes, uncompressed


@final
class McapFile:
    """
    An MCAP file of profile ros2 that grows by whole chunks.

    `library` is the name and version of the writing program.
    """

    def __init__(self, path: Path, library: str) -> None:
        self.path = path
        self._file = RecordFile(path)
        self._builder = ChunkBuilder()
        self._schemas: dict[MessageDefinition, Schema] = {}
        self._channels: list[Channel] = []
        self._chunk_index = CompressedRecords()
        self._span: tuple[int, int] | None = None
        self._metadata: list[MetadataIndex] = []
        self._summary_size = 0
        self.counts: Counter[int] = Counter()
        try:
            self._file.append(MAGIC + encode_records([Header('ros2', library)]))
        except BaseException:
            self._file.discard()
            raise

    @property
    def size(self) -> int:
        """Size of the file, without the pending chunk. [bytes]"""
        return self._file.size

    @property
    def start(self) -> int:
        """Earliest log time in the file. [ns]"""
        return 0 if self._span is None else self._span[0]

    @property
    def end(self) -> int:
        """Latest log time in the file. [ns]"""
        return 0 if self._span is None else self._span[1]

    @property
    def summary_size(self) -> int:
        """Space that `close` will need. [bytes]"""
        # An estimate from above is safe: it ends the recording slightly earlier
        return self._summary_size + 1024  # bytes for statistics, footer and the like

    @property
    def pending_count(self) -> int:
        """Number of messages that the next flush will write."""
        return self._builder.message_count

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record."""
        data = encode_records([Metadata(name, dict(values))])
        index = MetadataIndex(self._file.append(data), len(data), name)
        self._metadata.append(index)
        self._summary_size += len(encode_records([index]))

    def add_channel(self, topic: str, definition: MessageDefinition, qos: str) -> int:
        """Add a topic and return the number of its channel."""
        records: list[McapRecord] = []
        schema = self._schemas.get(definition)
        if schema is None:
            schema = Schema(
                # MCAP reserves schema id 0 for "no schema"
                id=len(self._schemas) + 1,
                # Keeps bytes of a copied definition that are not UTF-8
                data=definition.text.encode(errors='surrogateescape'),
                encoding=definition.encoding,
                name=definition.type_name,
            )
            records.append(schema)
        metadata = {
            'offered_qos_profiles': qos,
            'topic_type_hash': definition.rihs01,
        }
        channel = Channel(
            len(self._channels) + 1, topic, definition.message_encoding, metadata, schema.id
        )
        records.append(channel)
        data = encode_records(records)
        self._file.append(data)
        # Only after the write succeeded, so that a failed one leaves no channel without a record
        self._schemas[definition] = schema
        self._channels.append(channel)
        self._summary_size += len(data)
        return channel.id

    def add_message(
        self,
        channel: int,
        sequence: int,
        log_time: int,
        data: bytes,
        publish_time: int | None = None,
    ) -> None:
        """Add one message to the pending chunk, which is written when it is full."""
        self._builder.add(channel, sequence, log_time, data, publish_time)
        if self._builder.size >= CHUNK_SIZE:
            self.flush()

    def flush(self) -> None:
        """Write the pending chunk."""
        if not self._builder.size:
            return
        chunk = self._builder.build_chunk(self._file.size)
        self._file.append(chunk.data)
        index = chunk.index
        self._summary_size += self._chunk_index.add(index)
        start, end = self._span or (index.message_start_time, index.message_end_time)
        self._span = min(start, index.message_start_time), max(end, index.message_end_time)
        self.counts.update(chunk.counts)

    def close(self, *, sync: bool = True) -> None:
        """Write the summary and close the file; see `RecordFile.close`."""
        try:
            self._file.append(self._build_summary(self._file.size))
        finally:
            self._file.close(sync=sync)

    def discard(self) -> None:
        """Close the file and remove it."""
        self._file.discard()

    def _build_statistics(self) -> Statistics:
        """Return the statistics record of the file."""
        return Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=dict(self.counts),
            chunk_count=self._chunk_index.count,
            message_count=self.counts.total(),
            message_end_time=self.end,
            message_start_time=self.start,
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )

    def _build_summary(self, offset: int) -> bytes:
        """Return everything that follows the data: summary, footer and closing magic."""
        ending = encode_records([DataEnd(0)])  # CRC 0: not computed
        start = offset + len(ending)
        groups = {
            Opcode.SCHEMA: encode_records(self._schemas.values()),
            Opcode.CHANNEL: encode_records(self._channels),
            Opcode.STATISTICS: encode_records([self._build_statistics()]),
            Opcode.CHUNK_INDEX: self._chunk_index.decompress(),
            Opcode.METADATA_INDEX: encode_records(self._metadata),
        }
        body, places = b'', []
        for opcode, data in groups.items():
            if data:
                # One offset per group lets readers jump to the records of one kind
                places.append(SummaryOffset(opcode, start + len(body), len(data)))
            body += data
        footer = Footer(start, start + len(body), 0)
        body += encode_records(places)
        # By the specification the CRC covers the footer too, up to its own four bytes.
        footer.summary_crc = zlib.crc32(body + encode_records([footer])[:-4])
        return ending + body + encode_records([footer]) + MAGIC
