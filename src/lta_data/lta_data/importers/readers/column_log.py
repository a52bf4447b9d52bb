# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Serve columns that were read at once as a log, with times by the mapping.

A source (text, MATLAB, NumPy, Parquet, a folder of files) yields columns by table; a mapping says
which column is the time, for all tables or for one.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from datetime import date
from decimal import Decimal
from functools import partial
from pathlib import Path
import re
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.quantity import SI_UNITS
from lta_config.schema.import_file import ImportMapping as MappingFile
from lta_config.schema.import_file import TimeColumn
from lta_config.topics import load_topic_table
from lta_data.importers.log_provenance import CLOCK_KEY
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
    shorten_cell,
)
import numpy as np
from numpy.typing import NDArray
import pyarrow as pa

SECOND_NS: Final = 1_000_000_000
READABLE_TIME: Final = 2**62  # ns; the sum of two such times fits an int64
EPOCH_DAY: Final = date(1970, 1, 1)
LAST_HOUR: Final = 23  # of a day
MONTHS: Final = 12
# Date and time of day, to the second at least
TIME_OF_DAY: Final = (
    r'(?P<hour>\d\d?):(?P<minute>[0-5]\d):(?P<second>[0-5]\d(?:[.,]\d+)?)'
    r'(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?'
)
DATE: Final = re.compile(
    r'(?:(?P<year>\d{4})[-/](?P<month>\d\d)[-/](?P<day>\d\d)'
    r'|(?P<first>\d\d?)(?P<mark>[./])(?P<next>\d\d?)[./](?P<last>\d{4}))'
    r'[T ,]\s*' + TIME_OF_DAY + r'\s*(?P<zone>Z|z|UTC|[+-]\d\d:?\d\d|)'
)
COMPACT_DATE: Final = re.compile(r'(\d{4})(\d\d)(\d\d)T(\d\d)(\d\d)(\d\d)')
# A time of day without a date, or what has passed, as pandas writes it
CLOCK_TIME: Final = re.compile(r'(?:(?P<days>\d{1,4}) days?,? )?' + TIME_OF_DAY)
# Minutes and seconds, as spreadsheets show a time
ELAPSED_MINUTES: Final = re.compile(r'(?P<minute>\d+):(?P<second>[0-5]\d[.,]\d+)')
# A number with its unit, as MATLAB writes durations
DURATION: Final = re.compile(r'([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*(s|sec|ms|min|hr)')
DURATION_UNITS: Final = {'s': '1', 'sec': '1', 'ms': '0.001', 'min': '60', 'hr': '3600'}


ZONELESS: Final = 'The dates in the log have no time zone; UTC is assumed.'


class ParsedTimes(NamedTuple):
    """Times of rows, and what was assumed, a sentence each."""

    times: Times
    assumed: tuple[str, ...]


def compute_even_times(time: Any, rows: Times) -> Times:
    """Return the times of evenly spaced rows, without accumulated error [ns]."""
    period = SECOND_NS / time.rate.si if time.step is None else round(time.step.si * SECOND_NS)
    _check_readable(rows * (period / SECOND_NS), rows)
    # From the row number, so that rounding does not add up.
    times: Times = np.round(rows * period).astype(np.int64)
    return times


def round_to_nanoseconds(seconds: NDArray[np.float64]) -> Times:
    """Return times with the digits of a float in whole nanoseconds; raise `BadInput` if huge."""
    _check_readable(seconds, np.arange(len(seconds)))
    # Whole and fractional seconds apart: their product with 1e9 would lose digits
    whole = np.floor(seconds)
    times: Times = whole.astype(np.int64) * SECOND_NS
    return times + np.round((seconds - whole) * SECOND_NS).astype(np.int64)


def _check_readable(seconds: NDArray[np.float64], rows: Times) -> None:
    """Raise `BadInput` for times [s] that would overflow, in sums with a start, too."""
    wrong = np.flatnonzero(~(np.abs(seconds) < READABLE_TIME / SECOND_NS))
    if len(wrong):
        raise BadInput(
            f'Row {rows[wrong[0]] + 1} is at {seconds[wrong[0]]:g} s, outside the range of '
            'ROS time stamps; in the mapping, correct "time".'
        )


def parse_exact_times(texts: list[str], unit: str, column: str) -> ParsedTimes:
    """
    Parse decimals, dates with time of day or durations to integer nanoseconds.

    A date without a zone counts as UTC. `unit` is the unit of decimals.

    Raise `BadInput` if a cell is not a time; the message names the row.
    """
    # The first cell decides between plain numbers and the rest
    is_text = bool(texts) and is_time(texts[0])
    dates = [one for text in texts if (one := match_date(text))] if is_text else []
    month_first = is_month_first(dates)
    reading = (
        partial(parse_time, month_first=month_first) if is_text else build_decimal_parser(unit)
    )
    times = np.empty(len(texts), dtype=np.int64)
    for index, text in enumerate(texts):
        try:
            times[index] = reading(text)
        except OverflowError:
            raise BadInput(
                f"Column '{column}' has '{shorten_cell(text)}' in row {index + 1}, "
                'outside the range of ROS time stamps; in the mapping, correct the unit of "time".'
            ) from None
        except (ArithmeticError, ValueError):
            content = f"'{shorten_cell(text)}'" if text else 'nothing'
            raise BadInput(
                f"Column '{column}' has {content} in row {index + 1}, which is not a "
                'time; correct the row or remove it.'
            ) from None
    assumed = [ZONELESS] * any(not one['zone'] for one in dates)
    if dates and dates[0]['mark'] == '/':
        order = 'month and day' if month_first else 'day and month'
        assumed.append(f"Dates such as '{texts[0]}' are read as {order}.")
    return ParsedTimes(times, tuple(assumed))


def match_date(text: str) -> re.Match[str] | None:
    """Return the parts of a date with time of day; None for other text."""
    return DATE.fullmatch(COMPACT_DATE.sub(r'\1-\2-\3T\4:\5:\6', text.strip(), count=1))


def is_date(text: str) -> bool:
    """Return whether a text is a date with a time of day."""
    return match_date(text) is not None


def is_time(text: str) -> bool:
    """Return whether a text is a date, a time of day or a duration, and no mere number."""
    return is_date(text) or any(
        form.fullmatch(text.strip()) for form in (CLOCK_TIME, ELAPSED_MINUTES, DURATION)
    )


def parse_time(text: str, *, month_first: bool = False) -> int:
    """
    Return a date since 1970, a time of day or a duration, with all digits [ns].

    `month_first`: of dates with slashes. Raise `ValueError` for other text.
    """
    text, days = text.strip(), 0
    if match := DURATION.fullmatch(text):
        return _round_to_nanoseconds(Decimal(match[1]) * Decimal(DURATION_UNITS[match[2]]))
    parts = ELAPSED_MINUTES.fullmatch(text) or CLOCK_TIME.fullmatch(text)
    if dated := match_date(text):
        parts = dated
        days = (_read_day(dated, month_first=month_first) - EPOCH_DAY).days
        if int(dated['hour']) > LAST_HOUR:
            raise ValueError(text)
    if parts is None:
        raise ValueError(text)
    fields = parts.groupdict()
    hour = int(fields.get('hour') or 0)
    if half := fields.get('half'):  # noon is 12 PM, midnight 12 AM
        hour = hour % 12 + 12 * (half.lower() == 'p')
    minutes = 60 * (24 * (days + int(fields.get('days') or 0)) + hour) + int(fields['minute'])
    if (zone := fields.get('zone') or 'Z')[0] in '+-':
        minutes -= int(f'{zone[0]}1') * (60 * int(zone[1:3]) + int(zone[-2:]))
    return _round_to_nanoseconds(60 * minutes + Decimal(fields['second'].replace(',', '.')))


def _read_day(parts: re.Match[str], *, month_first: bool) -> date:
    """Return the day of a date; raise `ValueError` if the calendar has none such."""
    if parts['year']:
        return date(*(int(parts[key]) for key in ('year', 'month', 'day')))
    day, month = int(parts['first']), int(parts['next'])
    if month_first and parts['mark'] == '/':
        day, month = month, day
    return date(int(parts['last']), month, day)


def is_month_first(dates: Sequence[re.Match[str]]) -> bool:
    """
    Return whether dates with slashes begin with the month.

    A number above 12 is a day. Else the order is right in which the days follow each other most
    closely; on a single day, AM and PM show the American order.
    """
    slashed = [one for one in dates if one['mark'] == '/']
    days = {(int(one['first']), int(one['next'])) for one in slashed}
    if any(first > MONTHS for first, _ in days):
        return False
    if any(second > MONTHS for _, second in days):
        return True
    if len(days) > 1:
        steps = [
            np.abs(
                np.diff([_read_day(one, month_first=order).toordinal() for one in slashed])
            ).max()
            for order in (False, True)
        ]
        if steps[0] != steps[1]:
            return bool(steps[1] < steps[0])
    return any(one['half'] for one in slashed)


def _round_to_nanoseconds(seconds: Decimal) -> int:
    """Return seconds in whole nanoseconds; raise `OverflowError` if they are huge."""
    # An int of 1e999999 would take long
    if abs(seconds) >= READABLE_TIME // SECOND_NS:
        raise OverflowError(seconds)
    return int((seconds * SECOND_NS).to_integral_value())


def build_decimal_parser(unit: str) -> Callable[[str], int]:
    """Return a function that parses decimals in a unit of time [ns]."""
    # Decimal: float64 has too few digits for nanoseconds since 1970
    factor = Decimal(str(SI_UNITS[unit][1]))
    return lambda text: _round_to_nanoseconds(Decimal(text) * factor)


def choose_time_offset(first: int, notes: list[str], facts: dict[str, str]) -> int:
    """
    Return the offset of all times of a log: zero, unless they start near or below zero [ns].

    `first` is the earliest time [ns]; an offset is added to the notes and facts of the log.
    """
    start = load_topic_table().start_ns
    if first >= start:
        return 0
    # A whole number of seconds keeps the digits readable.
    shift = start - min(0, first // SECOND_NS) * SECOND_NS
    notes.append(
        f'The times in the log start at {first / SECOND_NS:g} s. {shift / SECOND_NS:g} s were '
        'added to all times, since in ROS time 0 means "no clock yet".'
    )
    facts.setdefault(CLOCK_KEY, 'from its own start')
    facts['time_shift'] = f'{shift / SECOND_NS:g} s'
    return shift


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
        """Return the times of a table [ns]."""
        time, table = self._times.get(name), self._tables[name]
        if time is None:
            raise BadInput(
                f"The mapping gives no time for the table '{name}' of '{self._path}'; add "
                '"time" to the topic that uses it.'
            )
        start = 0 if time.start is None else round(time.start.si * SECOND_NS)
        if time.column is None:
            rows = np.arange(len(next(iter(table.values()))), dtype=np.int64)
            if time.start is None:
                self.facts[CLOCK_KEY] = 'rows counted'
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
            times, assumed = parse_exact_times(texts, unit, name)
            self.notes += [note for note in assumed if note not in self.notes]
            return times
        factor = SI_UNITS[unit][1] * SECOND_NS
        largest = np.abs(cells.astype(np.float64)).max(initial=0.0)
        if cells.dtype.kind in 'iub' and largest < READABLE_TIME / factor:
            return cells.astype(np.int64) * round(factor)
        if not np.isfinite(cells).all():
            row = int(np.flatnonzero(~np.isfinite(cells))[0]) + 1
            raise BadInput(
                f"Column '{name}' has no time in row {row}; remove the row, or choose another "
                'column in the mapping.'
            )
        return round_to_nanoseconds(cells.astype(np.float64) * SI_UNITS[unit][1])

    def _choose_time_offset(self, stamps: Mapping[str, Times]) -> int:
        """Return the offset of all times, equal for all tables [ns]."""
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
