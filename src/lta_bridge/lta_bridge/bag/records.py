"""MCAP records as bytes, and the marks by which a recording of ours is known."""

from collections.abc import Iterable

from mcap.data_stream import RecordBuilder
from mcap.records import McapRecord

MAGIC = b'\x89MCAP0\r\n'
PROVENANCE = 'provenance'  # name of the metadata record


def encoded(records: Iterable[McapRecord]) -> bytes:
    """Return the bytes of some records, one after the other."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data
