"""Write a topic as Parquet: one row group per part, units in the metadata of the fields."""

from collections.abc import Iterator
from pathlib import Path

from lta_data.bag.table import build_arrow_field
from lta_data.export.source import ExportSource
import pyarrow as arrow
from pyarrow import parquet


def write_parquet(source: ExportSource, path: Path) -> Iterator[int]:
    """Write a file and yield the number of rows after each part."""
    fields = [
        build_arrow_field(name, kind, source.units) for name, kind in source.declared.items()
    ]
    about = {'topic': source.name, 'type': source.kind}
    schema = arrow.schema(fields, metadata=about)
    with parquet.ParquetWriter(path, schema, compression='zstd') as file:
        for part in source.parts():
            arrays = [arrow.array(values) for values in part.values()]
            file.write_table(arrow.table(arrays, schema=schema))
            yield len(arrays[0])
