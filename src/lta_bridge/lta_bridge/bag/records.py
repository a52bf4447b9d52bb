"""MCAP records as bytes, and the marks by which a recording of ours is known."""

from collections.abc import Iterable
from typing import final

from mcap.data_stream import RecordBuilder
from mcap.records import McapRecord
import zstandard

MAGIC = b'\x89MCAP0\r\n'
PROVENANCE = 'provenance'  # name of the metadata record


def encode_records(records: Iterable[McapRecord]) -> bytes:
    """Return the bytes of some records, one after the other."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data


@final
class CompressedRecords:
    """
    Records that wait for the summary, compressed.

    The summary says some 300 bytes of each chunk, mostly numbers that grow: packed they take a
    third, and as objects they would take ten times as much.
    """

    def __init__(self) -> None:
        self._packer = zstandard.ZstdCompressor(level=1).compressobj()
        self._packed = bytearray()
        self.count = 0

    def add(self, record: McapRecord) -> int:
        """Take one record and return its size. [bytes]"""
        data = encode_records([record])
        self._packed += self._packer.compress(data)
        self.count += 1
        return len(data)

    def decompress(self) -> bytes:
        """Return the bytes of all records so far."""
        self._packed += self._packer.flush(zstandard.COMPRESSOBJ_FLUSH_BLOCK)
        return zstandard.ZstdDecompressor().decompressobj().decompress(bytes(self._packed))
