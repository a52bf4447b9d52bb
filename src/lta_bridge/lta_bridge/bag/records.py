"""Encode MCAP records."""

from collections.abc import Iterable
from typing import final

from mcap.data_stream import RecordBuilder
from mcap.records import McapRecord
import zstandard

MAGIC = b'\x89MCAP0\r\n'
PROVENANCE = 'provenance'  # name of the metadata record


def encode_records(records: Iterable[McapRecord]) -> bytes:
    """Return the concatenated bytes of the records."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data


@final
class CompressedRecords:
    """
    Hold the summary's records compressed in memory.

    A chunk needs about 300 bytes in the summary. Compressed they take a third of that; kept as
    objects they would take ten times as much.
    """

    def __init__(self) -> None:
        self._packer = zstandard.ZstdCompressor(level=1).compressobj()
        self._packed = bytearray()
        self.count = 0

    def add(self, record: McapRecord) -> int:
        """Add one record and return its size. [bytes]"""
        data = encode_records([record])
        self._packed += self._packer.compress(data)
        self.count += 1
        return len(data)

    def decompress(self) -> bytes:
        """Return the bytes of all records so far."""
        # Ends a block only, not the frame: more records may follow.
        self._packed += self._packer.flush(zstandard.COMPRESSOBJ_FLUSH_BLOCK)
        return zstandard.ZstdDecompressor().decompressobj().decompress(bytes(self._packed))
