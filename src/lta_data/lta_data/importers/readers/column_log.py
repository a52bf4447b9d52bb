"""
Serve columns that were read at once as a log, with times by the mapping.

A source (text, MATLAB, NumPy, Parquet, a folder of files) yields columns by table; a mapping says
which column is the time, for all tables or for one.
"""

from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, final

from lta_config.errors import BadInput
from lta_config.quantity import UNITS
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_config.schema.import_file import TimeColumn
from lta_data.importers.log_provenance import CLOCK
from lta_data.importers.protocol import (
    encode_label,
    LogTable,
    PassThroughMessage,
    RawTopic,
    Reached,
    Times,
)
from lta_data.importers.readers.csv_text import (
    Cells,
    decode_cells,
    missing_columns_error,
    parse_cells,
    read_cells,
    read_column_names,
)
from lta_data.importers.readers.row_times import (
    choose_time_offset,
    compute_even_times,
    parse_exact_times,
    READABLE,
    round_to_nanoseconds,
    SECOND,
)
import numpy as np
from numpy.typing import NDArray
import pyarrow as pa

ZONELESS = 'The dates in the log have no time zone; UTC is assumed.'
Column = NDArray[Any]  # numbers, or texts such as dates
Tables = Mapping[str, Mapping[str, Cells | Column]]  # columns by table; a single table is ''


@final
class ColumnLog:
    """
    An opened log; see `protocol.LogReader`.

    Raise `BadInput` if the mapping gives no time for a table that it uses.
    """

    def __init__(self, path: Path, tables: Tables, notes: list[str], mapping: MappingFile) -> None:
        self._path = path
        self._tables = tables
        self._times = _list_table_times(tables, mapping)
        labels = {column for entry in mapping.topics for column in entry.labels}
        self.columns: Mapping[str, list[str]] = {
            name: [c for c, cells in table.items() if c in labels or _has_numbers(cells)]
            for name, table in tables.items()
        }
        self._labels = labels
        self.raw: Mapping[str, RawTopic] = {}
        self.notes = notes
        self.facts: dict[str, str] = {}
        self.timed = sorted({name for time in self._times.values() for name in time.columns})

    def read_tables(self, selection: Mapping[str, Collection[str]]) -> Mapping[str, LogTable]:
        """Return the selected tables, on one clock."""
        stamps = {name: self._read_stamps(name) for name in selection}
        shift = self._choose_time_offset(stamps)
        tables = {}
        for name, columns in selection.items():
            at = stamps[name] + shift
            table = self._tables[name]
            numbers, empty = {}, {}
            for column in self.columns[name]:
                cells = table[column]
                if isinstance(cells, pa.ChunkedArray) and column not in columns:
                    continue
                numbers[column] = self._convert(column, cells)
                if isinstance(cells, pa.ChunkedArray) and cells.null_count:
                    empty[column] = cells.is_null().to_numpy()
            rows = np.arange(len(at), dtype=np.int64)
            # Several tables are merged by time, a single one keeps its order
            order = rows if len(selection) == 1 else at
            tables[name] = LogTable(at, at, order, numbers, empty)
        return tables

    def _convert(self, column: str, cells: Cells | Column) -> NDArray[np.float64]:
        """Return cells as numbers; words that select rows get a number each."""
        if isinstance(cells, pa.ChunkedArray):
            if column not in self._labels:
                return parse_cells(self._path, column, cells)
            return np.array([encode_label(cell) for cell in decode_cells(cells)])
        if cells.dtype.kind in 'fiub':
            return cells.astype(np.float64)
        return np.array([encode_label(str(cell)) for cell in cells])

    def iterate_messages(self, reached: Reached) -> Iterator[PassThroughMessage]:
        """Yield nothing."""
        yield from ()

    def _read_stamps(self, name: str) -> Times:
        """Return the times of a table. [ns]"""
        time, table = self._times.get(name), self._tables[name]
        if time is None:
            raise BadInput(
                f"The mapping gives no time for the table '{name}' of '{self._path}'; add "
                '"time" to the topic that uses it.'
            )
        start = 0 if time.start is None else round(time.start.si * SECOND)
        if time.column is None:
            rows = np.arange(len(next(iter(table.values()))), dtype=np.int64)
            if time.start is None:
                self.facts[CLOCK] = 'rows counted'
            return compute_even_times(time, rows) + start
        if absent := [column for column in time.columns if column not in table]:
            raise missing_columns_error(self._path, absent, list(table))
        stamps = self._to_nanoseconds(table[time.column], time.unit, time.column) + start
        if time.fraction is not None:
            stamps += self._to_nanoseconds(table[time.fraction], time.fraction_unit, time.fraction)
        return stamps

    def _to_nanoseconds(self, cells: Cells | Column, unit: str, name: str) -> Times:
        """Return times in whole nanoseconds: integers exactly, floats to their own precision."""
        if isinstance(cells, pa.ChunkedArray) or cells.dtype.kind not in 'fiub':
            is_text = isinstance(cells, pa.ChunkedArray)
            texts = decode_cells(cells) if is_text else [str(cell) for cell in cells]
            times, is_zoneless = parse_exact_times(texts, unit, name)
            if is_zoneless and ZONELESS not in self.notes:
                self.notes.append(ZONELESS)
            return times
        factor = UNITS[unit][1] * SECOND
        largest = np.abs(cells.astype(np.float64)).max(initial=0.0)
        if cells.dtype.kind in 'iub' and largest < READABLE / factor:
            return cells.astype(np.int64) * round(factor)
        if not np.isfinite(cells).all():
            row = int(np.flatnonzero(~np.isfinite(cells))[0]) + 1
            raise BadInput(
                f"Column '{name}' has no time in row {row}; remove the row, or choose another "
                'column in the mapping.'
            )
        return round_to_nanoseconds(cells.astype(np.float64) * UNITS[unit][1])

    def _choose_time_offset(self, stamps: Mapping[str, Times]) -> int:
        """Return the offset of all times, equal for all tables. [ns]"""
        if all(self._times[name].start is not None for name in stamps):
            return 0
        first = min((int(times[0]) for times in stamps.values() if len(times)), default=0)
        return choose_time_offset(first, self.notes, self.facts)


def _has_numbers(cells: Cells | Column) -> bool:
    """Return whether cells are numbers, or may be: those of a text."""
    return isinstance(cells, pa.ChunkedArray) or cells.dtype.kind in 'fiub'


def _list_table_times(tables: Tables, mapping: MappingFile) -> dict[str, TimeColumn]:
    """Return the time of each table: its own, or that of the mapping."""
    times = {} if mapping.time is None else dict.fromkeys(tables, mapping.time)
    only = next(iter(tables)) if len(tables) == 1 else ''
    own = {entry.table or only: entry.time for entry in mapping.topics if entry.time is not None}
    return times | own


def open_text(path: Path, mapping: MappingFile) -> ColumnLog:
    """Open a text with columns; raise `BadInput` if it cannot be read as one."""
    cells, notes = read_cells(path, mapping.text, read_column_names(path, mapping.text))
    return ColumnLog(path, {'': cells}, notes, mapping)
