"""Compute the times of text rows: counted, from decimals or from dates, in whole ns."""

from collections.abc import Callable
from datetime import datetime, UTC
from decimal import Decimal
import re
from typing import Any, Final, NamedTuple

from lta_config.errors import BadInput
from lta_config.quantity import UNITS
from lta_config.topics import load_topic_table
from lta_data.importers.log_provenance import CLOCK
from lta_data.importers.protocol import Times
import numpy as np
from numpy.typing import NDArray

SECOND: Final = 1_000_000_000
READABLE: Final = 2**62  # ns; the sum of two such times fits an int64
EPOCH: Final = datetime(1970, 1, 1, tzinfo=UTC)
# ISO 8601 or RFC 3339 date-time, to the second at least; the fraction is a separate group.
DATE: Final = re.compile(
    r'(\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d|\d{8}T\d{6})(?:[.,](\d+))?\s*(Z|z|UTC|[+-]\d\d:?\d\d|)'
)


DOTTED: Final = re.compile(r'^(\d\d)\.(\d\d)\.(\d{4})(?=[T ])')  # as in 24.12.2026
# A time of day without a date
CLOCK_TIME: Final = re.compile(r'(\d\d?:\d\d:\d\d)(?:[.,](\d+))?')


class ParsedTimes(NamedTuple):
    """Times of rows, and whether one is a date without a time zone."""

    times: Times
    zoneless: bool


def compute_even_times(time: Any, rows: Times) -> Times:  # noqa: ANN401 - lta_config.schema.import_file.TimeColumn
    """Return the times of evenly spaced rows, without accumulated error. [ns]"""
    period = SECOND / time.rate.si if time.step is None else round(time.step.si * SECOND)
    _check_readable(rows * (period / SECOND), rows)
    # From the row number, so that rounding does not add up.
    times: Times = np.round(rows * period).astype(np.int64)
    return times


def round_to_nanoseconds(seconds: NDArray[np.float64]) -> Times:
    """Return times with the digits of a float in whole nanoseconds; raise `BadInput` if huge."""
    _check_readable(seconds, np.arange(len(seconds)))
    # Whole and fractional seconds apart: their product with 1e9 would lose digits
    whole = np.floor(seconds)
    times: Times = whole.astype(np.int64) * SECOND
    return times + np.round((seconds - whole) * SECOND).astype(np.int64)


def _check_readable(seconds: NDArray[np.float64], rows: Times) -> None:
    """Raise `BadInput` for times [s] that would overflow, in sums with a start, too."""
    wrong = np.flatnonzero(~(np.abs(seconds) < READABLE / SECOND))
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
    # The first cell decides between dates and decimals
    dates = bool(texts) and split_date(texts[0]) is not None
    reading = parse_date if dates else build_decimal_parser(unit)
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
    zoneless = dates and any(find_time_zone(text) == '' for text in texts)
    return ParsedTimes(times, zoneless)


def split_date(text: str) -> tuple[str, str, str] | None:
    """
    Return a date to the second, the fraction of the second and the time zone; None for other text.

    A time of day is one of the first day of 1970.
    """
    text = DOTTED.sub(r'\3-\2-\1', text.strip())
    if match := DATE.fullmatch(text):
        return match[1], match[2] or '0', match[3]
    if match := CLOCK_TIME.fullmatch(text):
        return f'1970-01-01T{match[1].zfill(8)}', match[2] or '0', 'Z'
    return None


def find_time_zone(text: str) -> str | None:
    """Return the time zone of a date as written, '' without one; None if it is not a date."""
    parts = split_date(text)
    return None if parts is None else parts[2]


def build_decimal_parser(unit: str) -> Callable[[str], int]:
    """Return a function that parses decimals in a unit of time. [ns]"""
    # Decimal: float64 has too few digits for nanoseconds since 1970
    factor = Decimal(str(UNITS[unit][1])) * SECOND

    def parse(text: str) -> int:
        time = Decimal(text) * factor
        # An int of 1e999999 would take long
        if abs(time) >= READABLE:
            raise OverflowError(text)
        return int(time.to_integral_value())

    return parse


def parse_date(text: str) -> int:
    """Return the time of a date since 1970, with all digits of its second. [ns]"""
    parts = split_date(text)
    if parts is None:
        raise ValueError(text)
    whole, fraction, zone = parts
    zone = '+00:00' if zone in ('', 'Z', 'z', 'UTC') else zone
    passed = datetime.fromisoformat(whole.replace(' ', 'T') + zone) - EPOCH
    # Apart from the whole seconds, since datetime resolves microseconds only
    nanoseconds = int(Decimal(f'0.{fraction}').scaleb(9).to_integral_value())
    return (passed.days * 86_400 + passed.seconds) * SECOND + nanoseconds


def shorten_cell(cell: str) -> str:
    """Shorten a cell to one line for an error message."""
    return ' '.join(cell[:40].split())


def choose_time_offset(first: int, notes: list[str], facts: dict[str, str]) -> int:
    """
    Return the offset of all times of a log: zero, unless they start near or below zero. [ns]

    `first` is the earliest time [ns]; an offset is added to the notes and facts of the log.
    """
    start = load_topic_table().start_ns
    if first >= start:
        return 0
    # A whole number of seconds keeps the digits readable.
    shift = start - min(0, first // SECOND) * SECOND
    notes.append(
        f'The times in the log start at {first / SECOND:g} s. {shift / SECOND:g} s were added '
        'to all times, since in ROS time 0 means "no clock yet".'
    )
    facts.setdefault(CLOCK, 'from its own start')
    facts['time_shift'] = f'{shift / SECOND:g} s'
    return shift
