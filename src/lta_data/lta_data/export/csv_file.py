"""Write a topic as CSV: one header line, no comments; the units of all files are in units.csv."""

from collections.abc import Iterable, Iterator
import csv
from pathlib import Path
from typing import Final

from lta_data.bag.table import build_arrow_field
from lta_data.export.source import ExportSource
import pyarrow as arrow
from pyarrow import csv as arrow_csv

UNITS: Final = 'units.csv'


def write_csv(source: ExportSource, path: Path) -> Iterator[int]:
    """Write a file and yield the number of rows after each part."""
    fields = [
        build_arrow_field(name, kind, source.units) for name, kind in source.declared.items()
    ]
    schema = arrow.schema(fields)
    with arrow_csv.CSVWriter(path, schema) as file:
        for part in source.parts():
            arrays = [arrow.array(values) for values in part.values()]
            file.write_table(arrow.table(arrays, schema=schema))
            yield len(arrays[0])


def write_units(files: Iterable[tuple[str, ExportSource]], folder: Path) -> None:
    """Write the unit of each column of each file; '' if unknown."""
    with (folder / UNITS).open('w', newline='', encoding='utf-8') as file:
        writer = csv.writer(file)
        writer.writerow(['file', 'topic', 'column', 'unit'])
        for name, source in files:
            for column in source.declared:
                writer.writerow([name, source.name, column, source.units.get(column, '')])
