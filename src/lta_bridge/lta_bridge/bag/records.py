"""MCAP records as bytes."""

from collections.abc import Iterable

from mcap.data_stream import RecordBuilder
from mcap.records import McapRecord


def encoded(records: Iterable[McapRecord]) -> bytes:
    """Return the bytes of some records, one after the other."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data
