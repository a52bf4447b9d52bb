# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write an MCAP file that stays readable after a crash or a full disk, with mcap's writer.

The writer counts a message before its chunk is on the disk, and lists a chunk that did not fit
in its summary. So it gets the messages of a chunk together, and writes into a `RecordFile`, which
stores a chunk whole or not at all. After a chunk that failed, the file ends without a summary, as
MCAP allows: readers scan it.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
import sys
from typing import cast, final, IO

from lta_bag.schemas import MessageDefinition
from lta_bag.storage import RecordFile, StorageFault
from mcap.data_stream import RecordBuilder
from mcap.records import DataEnd, Footer
from mcap.writer import MCAP0_MAGIC, Writer

PROVENANCE = 'provenance'  # name of the metadata record
CHUNK_SIZE = 1 << 20  # bytes, uncompressed
MESSAGE_HEAD = 31  # bytes of a message record before its data
# Sizes in the summary, without names and texts [bytes]
CHUNK_INDEX_BYTES = 81
CHUNK_INDEX_CHANNEL = 10
SCHEMA_BYTES = 23
CHANNEL_BYTES = 100  # with the keys of its metadata
OTHER_RECORDS_BYTES = 1024  # statistics, indexes of metadata, offsets, footer


@final
class McapFile:
    """
    An MCAP file of profile ros2 that grows by whole chunks.

    `library` is the name and version of the writing program.
    """

    def __init__(self, path: Path, library: str, provenance: Mapping[str, str]) -> None:
        self.path = path
        self._file = RecordFile(path)
        # Chunks end in `flush` only, so that each is stored whole
        self._writer = Writer(cast('IO[bytes]', self._file), chunk_size=sys.maxsize)
        self._schemas: dict[MessageDefinition, int] = {}
        self._pending: list[tuple[int, int, bytes, int, int]] = []
        self._pending_size = 0
        # Space that `close` will need, estimated from above: that is safe [bytes]
        self.summary_size = OTHER_RECORDS_BYTES
        self._intact = True  # what the writer has counted is in the file
        self.start = self.end = 0  # first and last log time in the file [ns]
        self.counts: Counter[int] = Counter()
        try:
            self._writer.start('ros2', library)
            self._writer.add_metadata(PROVENANCE, dict(provenance))
            self._file.flush()
        except BaseException:
            self._file.discard()
            raise

    @property
    def size(self) -> int:
        """Size of the file, without the pending messages [bytes]."""
        return self._file.size

    @property
    def pending_count(self) -> int:
        """Return the number of messages that the next flush will write."""
        return len(self._pending)

    def add_channel(self, topic: str, definition: MessageDefinition, qos: str) -> int:
        """Add a topic and return the number of its channel."""
        with self._change_writer():
            if definition not in self._schemas:
                # Keeps bytes of a copied definition that are not UTF-8
                text = definition.text.encode(errors='surrogateescape')
                self._schemas[definition] = self._writer.register_schema(
                    definition.type_name, definition.encoding, text
                )
                names = len(definition.type_name.encode()) + len(definition.encoding.encode())
                self.summary_size += SCHEMA_BYTES + names + len(text)
            metadata = {'offered_qos_profiles': qos, 'topic_type_hash': definition.rihs01}
            self.summary_size += CHANNEL_BYTES + len(definition.message_encoding.encode())
            self.summary_size += sum(len(x.encode()) for x in (topic, qos, definition.rihs01))
            return self._writer.register_channel(
                topic, definition.message_encoding, self._schemas[definition], metadata
            )

    def add_message(
        self,
        channel: int,
        sequence: int,
        log_time: int,
        data: bytes,
        publish_time: int | None = None,
    ) -> None:
        """Add one message to the pending chunk, which is written when it is full."""
        if publish_time is None:
            publish_time = log_time
        self._pending.append((channel, log_time, data, publish_time, sequence))
        self._pending_size += MESSAGE_HEAD + len(data)
        if self._pending_size >= CHUNK_SIZE:
            self.flush()

    def flush(self) -> None:
        """Write the pending messages as one chunk; if that fails, they are lost."""
        messages, self._pending, self._pending_size = self._pending, [], 0
        if not messages or not self._intact:
            return
        with self._change_writer():
            for message in messages:
                self._writer.add_message(*message)
            self._writer.flush()  # type: ignore[no-untyped-call]
        counts = Counter(message[0] for message in messages)
        times = [message[1] for message in messages]
        self.start = min(self.start, *times) if self.counts else min(times)
        self.end = max(self.end, *times)
        self.counts.update(counts)
        self.summary_size += CHUNK_INDEX_BYTES + CHUNK_INDEX_CHANNEL * len(counts)

    def close(self) -> None:
        """Finish and close the file, with a summary if it is right; see `RecordFile.close`."""
        try:
            if self._intact:
                with self._change_writer():
                    self._writer.finish()  # type: ignore[no-untyped-call]
                    self._file.flush()
        finally:
            if not self._intact:
                self._file.drop()
                with suppress(StorageFault):
                    self._file.write(encode_end_without_summary())
                    self._file.flush()
            self._file.close()

    @contextmanager
    def _change_writer(self) -> Iterator[None]:
        """Distrust the writer's counts if a step fails, or Ctrl-C interrupts it."""
        self._intact, intact = False, self._intact
        yield
        self._intact = intact


def encode_end_without_summary() -> bytes:
    """Return the end of an MCAP file that has no summary."""
    builder = RecordBuilder()
    DataEnd(0).write(builder)  # CRC 0: not computed
    Footer(summary_start=0, summary_offset_start=0, summary_crc=0).write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data + MCAP0_MAGIC
