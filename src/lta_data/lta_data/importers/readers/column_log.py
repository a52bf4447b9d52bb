"""
Serve columns that were read at once as a log, with times by the mapping.

A source (text, MATLAB, NumPy, Parquet, a folder of files) yields columns by table; a mapping says
which column is the time, for all tables or for one.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from datetime import datetime, timedelta, UTC
from decimal import Decimal
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
EPOCH_DATE: Final = datetime(1970, 1, 1, tzinfo=UTC)
# Date and time of day, to the second at least; the fraction is a separate group
TIME_OF_DAY: Final = r'(\d\d?)(:\d\d:\d\d)(?:[.,](\d+))?(?:\s*([AaPp])\.?[Mm]\.?)?'
DATE: Final = re.compile(
    r'(\d{4}[-/]\d\d[-/]\d\d|\d\d?[./]\d\d?[./]\d{4})[T ,]\s*' + TIME_OF_DAY +
    r'\s*(Z|z|UTC|[+-]\d\d:?\d\d|)'
)  # fmt: skip
COMPACT_DATE: Final = re.compile(r'(\d{8}T\d{6})(?:[.,](\d+))?\s*(Z|z|UTC|[+-]\d\d:?\d\d|)')
# A time of day without a date, or what has passed, as pandas writes it
CLOCK_TIME: Final = re.compile(r'(?:(\d{1,4}) days?,? )?' + TIME_OF_DAY)
# Minutes and seconds, as spreadsheets show a time
MINUTES: Final = re.compile(r'(\d\d?):(\d\d)[.,](\d+)')
# A number with its unit, as MATLAB writes durations
DURATION: Final = re.compile(r'([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*(s|sec|ms|min|hr)')
DURATION_UNITS: Final = {'s': '1', 'sec': '1', 'ms': '0.001', 'min': '60', 'hr': '3600'}


ZONELESS: Final = 'The dates in the log have no time zone; UTC is assumed.'


class ParsedTimes(NamedTuple):
    """Times of rows, and what was assumed, a sentence each."""

    times: Times
    assumed: tuple[str, ...]


def compute_even_times(time: Any, rows: Times) -> Times:  # noqa: ANN401 - lta_config.schema.import_file.TimeColumn
    """Return the times of evenly spaced rows, without accumulated error. [ns]"""
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
    Parse decimals or dates with time of day to integer nanoseconds.

    A date without a zone counts as UTC. `unit` is the unit of decimals.

    Raise `BadInput` if a cell is not a time; the message names the row.
    """
    # The first cell decides between dates, durations and decimals
    dates = bool(texts) and split_date(texts[0]) is not None
    reading = build_date_parser(texts) if dates else build_decimal_parser(unit)
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
    assumed = [ZONELESS] * (dates and any(find_time_zone(text) == '' for text in texts))
    if dates and texts[0].count('/') == 2 and texts[0].find('/') < 3:
        order = 'month and day' if is_month_first(texts) else 'day and month'
        assumed.append(f"Dates such as '{texts[0]}' are read as {order}.")
    return ParsedTimes(times, tuple(assumed))


def split_date(text: str, *, month_first: bool = False) -> tuple[str, str, str] | None:
    """
    Return a date to the second, the fraction of the second and the time zone; None for other text.

    A time of day, or what has passed, is one of 1970. `month_first`: of dates with slashes.
    """
    text = text.strip()
    if match := COMPACT_DATE.fullmatch(text):
        return match[1], match[2] or '0', match[3]
    if match := DATE.fullmatch(text):
        day, *time, zone = match.groups()
        parts = re.split('[-./]', day)
        if len(parts[0]) < 4:
            middle_first = '/' in day and month_first
            parts = [parts[2], *(parts[:2] if middle_first else parts[1::-1])]
        date = '-'.join(part.zfill(2) for part in parts)
    elif match := CLOCK_TIME.fullmatch(text):
        days, *time = match.groups()
        date, zone = str(EPOCH_DATE.date() + timedelta(days=int(days or 0))), 'Z'
    elif match := MINUTES.fullmatch(text):
        return f'1970-01-01T00:{int(match[1]):02}:{match[2]}', match[3], 'Z'
    else:
        return None
    hour, rest, fraction, half = time
    if half:  # noon is 12 PM, midnight 12 AM
        hour = str(int(hour) % 12 + 12 * (half.lower() == 'p'))
    return f'{date}T{hour.zfill(2)}{rest}', fraction or '0', zone


def is_month_first(texts: Sequence[str]) -> bool:
    """Return whether dates with slashes begin with the month: by a half of the day, or a day."""
    if texts[0].strip().endswith(('M', 'm')):
        return True
    days = [text.split('/')[1:2] for text in texts]
    return any(len(day[0]) == 2 and '12' < day[0] <= '31' for day in days if day)


def is_time(text: str) -> bool:
    """Return whether a text is a date with a time of day, or a duration with its unit."""
    return split_date(text) is not None or DURATION.fullmatch(text.strip()) is not None


def find_time_zone(text: str) -> str | None:
    """Return the time zone of a date as written, '' without one; None if it is not a date."""
    parts = split_date(text)
    return None if parts is None else parts[2]


def build_decimal_parser(unit: str) -> Callable[[str], int]:
    """Return a function that parses decimals in a unit of time. [ns]"""
    # Decimal: float64 has too few digits for nanoseconds since 1970
    factor = Decimal(str(SI_UNITS[unit][1])) * SECOND_NS

    def parse(text: str) -> int:
        if match := DURATION.fullmatch(text.strip()):
            time = Decimal(match[1]) * Decimal(DURATION_UNITS[match[2]]) * SECOND_NS
        else:
            time = Decimal(text) * factor
        # An int of 1e999999 would take long
        if abs(time) >= READABLE_TIME:
            raise OverflowError(text)
        return int(time.to_integral_value())

    return parse


def build_date_parser(texts: Sequence[str]) -> Callable[[str], int]:
    """Return a function that parses dates like these since 1970, with all digits. [ns]"""
    month_first = is_month_first(texts)

    def parse(text: str) -> int:
        parts = split_date(text, month_first=month_first)
        if parts is None:
            raise ValueError(text)
        whole, fraction, zone = parts
        zone = '+00:00' if zone in ('', 'Z', 'z', 'UTC') else zone
        passed = datetime.fromisoformat(whole + zone) - EPOCH_DATE
        # Apart from the whole seconds, since datetime resolves microseconds only
        nanoseconds = int(Decimal(f'0.{fraction}').scaleb(9).to_integral_value())
        return (passed.days * 86_400 + passed.seconds) * SECOND_NS + nanoseconds

    return parse


def choose_time_offset(first: int, notes: list[str], facts: dict[str, str]) -> int:
    """
    Return the offset of all times of a log: zero, unless they start near or below zero. [ns]

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
            numbers = {}
            for column in self.columns[name]:
                cells = table[column]
                if isinstance(cells, pa.ChunkedArray) and column not in columns:
                    continue
                numbers[column] = self._convert(column, cells)
            rows = np.arange(len(at), dtype=np.int64)
            # Several tables are merged by time, a single one keeps its order
            order = rows if len(selection) == 1 else at
            tables[name] = LogTable(at, at, order, numbers)
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
