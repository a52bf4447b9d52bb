"""
Serve arrays that were read at once as a log, with times by the mapping.

A source (MATLAB, NumPy, Parquet, a folder of files) yields columns by table; a mapping says which
column is the time, for all tables or for one.
"""

from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, final

from lta_config.errors import BadInput
from lta_config.quantity import UNITS
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_config.schema.import_file import TimeColumn
from lta_data.importers.log_provenance import CLOCK
from lta_data.importers.log_table import encode_label, LogTable, Times
from lta_data.importers.protocol import PassThroughMessage, RawTopic, Reached
from lta_data.importers.readers.csv_text import missing_columns_error
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

Column = NDArray[Any]  # numbers, or texts such as dates
Tables = Mapping[str, Mapping[str, Column]]  # columns by table; a single table is ''


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
            name: [c for c, cells in table.items() if c in labels or cells.dtype.kind in 'fiub']
            for name, table in tables.items()
        }
        self.raw: Mapping[str, RawTopic] = {}
        self.notes = notes
        self.facts: dict[str, str] = {}
        self.timed = sorted({name for time in self._times.values() for name in time.columns})

    def iterate_tables(
        self, selection: Mapping[str, Collection[str]], reached: Reached
    ) -> Iterator[Mapping[str, LogTable]]:
        """Yield all selected tables at once, on one clock."""
        # Reading is done, writing the bag is not
        reached(0.5)
        stamps = {name: self._read_stamps(name) for name in selection}
        shift = self._choose_time_offset(stamps)
        tables = {}
        for name in selection:
            at = stamps[name] + shift
            numbers = {
                column: _to_floats(self._tables[name][column]) for column in self.columns[name]
            }
            rows = np.arange(len(at), dtype=np.int64)
            # Several tables are merged by time, a single one keeps its order
            tables[name] = LogTable(at, at, rows if len(selection) == 1 else at, numbers)
        yield tables

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
            self.facts[CLOCK] = 'rows counted'
            return compute_even_times(time, rows) + start
        if absent := [column for column in time.columns if column not in table]:
            raise missing_columns_error(self._path, absent, list(table))
        stamps = _to_nanoseconds(table[time.column], time.unit, time.column) + start
        if time.fraction is not None:
            stamps += _to_nanoseconds(table[time.fraction], time.fraction_unit, time.fraction)
        return stamps

    def _choose_time_offset(self, stamps: Mapping[str, Times]) -> int:
        """Return the offset of all times, equal for all tables. [ns]"""
        if all(self._times[name].start is not None for name in stamps):
            return 0
        first = min((int(times.min()) for times in stamps.values() if len(times)), default=0)
        return choose_time_offset(first, self.notes, self.facts)


def _to_floats(cells: Column) -> NDArray[np.float64]:
    """Return cells as numbers; words that select rows get a number each."""
    if cells.dtype.kind in 'fiub':
        return cells.astype(np.float64)
    return np.array([encode_label(str(cell)) for cell in cells])


def _list_table_times(tables: Tables, mapping: MappingFile) -> dict[str, TimeColumn]:
    """Return the time of each table: its own, or that of the mapping."""
    times = {} if mapping.time is None else dict.fromkeys(tables, mapping.time)
    only = next(iter(tables)) if len(tables) == 1 else ''
    own = {entry.table or only: entry.time for entry in mapping.topics if entry.time is not None}
    return times | own


def _to_nanoseconds(cells: Column, unit: str, name: str) -> Times:
    """Return times in whole nanoseconds: integers exactly, floats to their own precision."""
    if cells.dtype.kind not in 'fiub':
        return parse_exact_times([str(cell) for cell in cells], unit, name, 0)[0]
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
