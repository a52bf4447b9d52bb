"""When the rows of a text were measured: counted, from decimals, or from dates; in whole ns."""

from collections.abc import Callable
from datetime import datetime, UTC
from decimal import Decimal, InvalidOperation
import re
from typing import Any, Final, NamedTuple

from lta_config.errors import BadInput
from lta_config.quantity import UNITS
from lta_data.importers.log_table import Times
import numpy as np

SECOND: Final = 1_000_000_000
EPOCH: Final = datetime(1970, 1, 1, tzinfo=UTC)
# A date-time as ISO 8601 and RFC 3339 write it: to the second at least, its fraction apart.
DATE: Final = re.compile(
    r'(\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d|\d{8}T\d{6})(?:[.,](\d+))?\s*(Z|z|UTC|[+-]\d\d:?\d\d|)'
)


class ParsedTimes(NamedTuple):
    """Times of rows, and whether one of them is a date without a time zone."""

    times: Times
    zoneless: bool


def compute_even_times(time: Any, rows: Times) -> Times:  # noqa: ANN401 - lta_config.schema.import_file.TimeColumn
    """Return the times of rows that come evenly, never a sum. [ns]"""
    if time.step is None:
        found: Times = np.round(rows * (SECOND / time.rate.si)).astype(np.int64)
    else:
        found = rows * round(time.step.si * SECOND)
    return found


def parse_exact_times(texts: list[str], unit: str, column: str, first: int) -> ParsedTimes:
    """
    Return times as integer nanoseconds, from decimals or from dates with the time of day.

    Parameters
    ----------
    texts : list of str
        The cells.
    unit : str
        Of the decimals.
    column : str
        Whose cells they are, for the error.
    first : int
        Rows before the first cell.

    Returns
    -------
    Zoneless
        A date without a zone counts as UTC.

    Raises
    ------
    BadInput
        If a cell is no time; it names the row.

    """
    dates = bool(texts) and DATE.fullmatch(texts[0].strip()) is not None
    reading = parse_date if dates else build_decimal_parser(unit)
    found = np.empty(len(texts), dtype=np.int64)
    for index, text in enumerate(texts):
        try:
            found[index] = reading(text)
        except (InvalidOperation, OverflowError, ValueError):
            told = f"'{format_cell(text)}'" if text else 'nothing'
            raise BadInput(
                f"Column '{column}' has {told} in row {first + index + 1}, which is no time; "
                'correct the row or take it out.'
            ) from None
    zoneless = dates and any(find_time_zone(text) == '' for text in texts)
    return ParsedTimes(found, zoneless)


def find_time_zone(text: str) -> str | None:
    """Return the time zone of a date as it is written, '' without one; None of no date."""
    found = DATE.fullmatch(text.strip())
    return None if found is None else found[3]


def build_decimal_parser(unit: str) -> Callable[[str], int]:
    """Return what reads a decimal number in a unit of time. [ns]"""
    factor = Decimal(str(UNITS[unit][1])) * SECOND
    return lambda text: int((Decimal(text) * factor).to_integral_value())


def parse_date(text: str) -> int:
    """Return the time of a date since 1970, every digit of its second kept. [ns]"""
    found = DATE.fullmatch(text.strip())
    if found is None:
        raise ValueError(text)
    whole, fraction, zone = found.groups()
    zone = '+00:00' if zone in ('', 'Z', 'z', 'UTC') else zone
    passed = datetime.fromisoformat(whole.replace(' ', 'T') + zone) - EPOCH
    parts = int(Decimal(f'0.{fraction or 0}').scaleb(9).to_integral_value())
    return (passed.days * 86_400 + passed.seconds) * SECOND + parts


def format_cell(cell: str) -> str:
    """Return a cell as one line for a message."""
    return ' '.join(cell[:40].split())
