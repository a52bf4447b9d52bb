"""Write a sweep as a Parquet table: a row per flight, columns with unit and description."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, Final

from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput
from lta_flight.report.results import FlightResults
from lta_flight.sweep.job_runner import SweepRow
import pyarrow as arrow
from pyarrow import parquet

TABLE_NAME = 'flights.parquet'
FIXED_COLUMNS: Final = (
    ('index', arrow.int64(), '', 'number of the flight in the sweep, from 0'),
    ('seed', arrow.int64(), '', 'random seed of the flight'),
    ('outcome', arrow.string(), '', 'reached, timeout, escaped, or failed (could not be flown)'),
    ('sentence', arrow.string(), '', 'outcome as a sentence, or why the flight failed'),
    ('wall', arrow.float64(), 's', 'computing time of the flight'),
)


def write_table(
    rows: Sequence[SweepRow], units: Mapping[str, str], about: Mapping[str, str], path: Path
) -> None:
    """
    Write the rows of a sweep.

    `units`: SI unit of each varied path; '' if it has none. `about`: metadata of the file: its
    provenance. `path`: parquet file; replaced as a whole. Raise `BadInput` if it cannot be
    written.
    """
    columns, declared = [], []
    for name, kind, unit, meaning in FIXED_COLUMNS:
        columns.append(arrow.array([getattr(row, name) for row in rows], kind))
        declared.append(_build_field(name, kind, unit, meaning))
    for varied, unit in units.items():
        values = [row.values.get(varied) for row in rows]
        kind = _column_type(values)
        columns.append(arrow.array(values, kind))
        declared.append(_build_field(varied, kind, unit, 'varied'))
    for item in fields(FlightResults):
        # All other results are numbers, or null if unknown
        kind = arrow.bool_() if item.name == 'success' else arrow.float64()
        columns.append(arrow.array([row.figures.get(item.name) for row in rows], kind))
        declared.append(
            _build_field(item.name, kind, item.metadata['unit'], item.metadata['about'])
        )
    # Units and descriptions are stored in the schema
    table = arrow.table(columns, schema=arrow.schema(declared, metadata=dict(about)))
    try:
        with replace_atomically(path) as part:
            parquet.write_table(table, part, compression='zstd')
    except OSError as error:
        raise BadInput(
            f"'{path}' cannot be written ({error}); check that its folder is writable and has "
            'free space.'
        ) from None


def _build_field(name: str, kind: Any, unit: str, meaning: str) -> Any:  # noqa: ANN401 - pyarrow's
    return arrow.field(name, kind, metadata={'unit': unit, 'about': meaning})


def _column_type(values: Sequence[Any]) -> Any:  # noqa: ANN401 - pyarrow's
    """Return the type of a varied column: number, list of numbers, bool, or text."""
    # A path may have no value in the rows of other cases
    first = next((value for value in values if value is not None), 0.0)
    if isinstance(first, list):
        return arrow.list_(arrow.float64())
    if isinstance(first, bool):
        return arrow.bool_()
    return arrow.float64() if isinstance(first, int | float) else arrow.string()
