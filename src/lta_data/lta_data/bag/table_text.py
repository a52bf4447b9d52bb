"""Format a table for a notebook: a heading, and a line per main column."""

from collections.abc import Iterator, Sequence
import re
from typing import Any, Final, TYPE_CHECKING

from lta_report.formatting import format_count
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from lta_data.bag.table import RecordingTable

DIM: Final = re.compile(
    r'(^|/|\.)header\.|covariance($|\[|/)'
)  # columns that are hidden by default
SHOWN: Final = 24  # columns printed, at most


def format_heading(table: 'RecordingTable') -> str:
    """Return the heading of a table."""
    if not len(table):
        return f'{table.name}: no rows'
    first, last = float(table.time[0]), float(table.time[-1])
    rate = f', {(len(table) - 1) / (last - first):.4g} Hz' if last > first else ''
    kind = f', {table.kind}' if table.kind else ''
    count = format_count(len(table), 'row')
    return f'{table.name}: {count} from {first:.2f} to {last:.2f} s{rate}{kind}'


def format_column_lines(table: 'RecordingTable') -> Iterator[str]:
    """Yield a line for each main column, then the number of the others."""
    seen = [column for column in table.columns if not DIM.search(column)]
    width = max(map(len, seen[:SHOWN]), default=0)
    for column in seen[:SHOWN]:
        unit, values = table.units.get(column, ''), format_range(table[column])
        yield f'  {column:{width}}  {unit:8} {values}'.rstrip()
    if hidden := len(table.columns) - len(seen[:SHOWN]):
        yield f'  and {hidden} more columns (see .columns)'


def format_range(values: NDArray[Any]) -> str:
    """Return the range of a column, or examples of its texts."""
    if not len(values):
        return ''
    if values.dtype.kind in 'Ub':
        return format_examples([str(value) for value in np.unique(values)])
    finite = values[np.isfinite(values)]
    return f'{finite.min():.4g} to {finite.max():.4g}' if len(finite) else 'no finite value'


def format_examples(texts: Sequence[str]) -> str:
    """Return the first few texts."""
    return ', '.join(texts[:3]) + (', ...' if len(texts) > 3 else '')
