# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A long table of results: one row an item.

A column carries name, unit, digits, meaning and, where there are any, the paper's values.
Terminal, page and Markdown show the table in display units, and JSON holds it in SI units, so that
a study names each of its numbers once.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
import math
from statistics import fmean
from typing import Any, Final, final, Generic, NamedTuple, Protocol, runtime_checkable, TypeVar

from lta_config.quantity import SI_UNITS
from lta_report.formatting import format_number, MISSING
from lta_report.json_value import to_json_value
from lta_report.report import CellColor, TextTable

Row = TypeVar('Row')
TYPED: Final = str.maketrans({'²': '2', '³': '3', '°': 'deg'})  # signs of units, as in files


@runtime_checkable
class Interval(Protocol):
    """A value with the ends of its interval, NaN where it has none."""

    @property
    def value(self) -> float:
        """Best value."""

    @property
    def low(self) -> float:
        """Lower end."""

    @property
    def high(self) -> float:
        """Upper end."""


class Spread(NamedTuple):
    """A mean and the deviation of a single item from it, which is not shown if it rounds to 0."""

    mean: float
    deviation: float


def unit_factor(unit: str) -> float:
    """Return by what a value in SI units is multiplied to have a unit, such as 'mW' or '°'."""
    return 1.0 / SI_UNITS[unit.strip('±').translate(TYPED)][1] if unit else 1.0


def format_value(value: Any, digits: int | None = None, factor: float = 1.0) -> str:
    """
    Return a cell: a number, an interval, a spread, or words.

    `digits`: of numbers after the point; None for as few as needed. A dash stands for None, NaN
    and infinity, 'yes' or 'no' for a bool.
    """
    if isinstance(value, Spread):
        mean, off = (format_value(each, digits, factor) for each in value)
        # A deviation that rounds to zero would claim more than it knows
        return mean if off == MISSING or not float(off) else f'{mean}\N{PLUS-MINUS SIGN}{off}'
    if isinstance(value, Interval):
        best, low, high = (
            format_value(each, digits, factor) for each in (value.value, value.low, value.high)
        )
        return best if MISSING in {best, low} else f'{best} ({low} to {high})'
    if isinstance(value, bool):
        return 'yes' if value else 'no'
    if isinstance(value, list | tuple):
        return ', '.join(format_value(each, digits, factor) for each in value) or MISSING
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return MISSING
    if isinstance(value, str):
        return value or MISSING
    return f'{value * factor:g}' if digits is None else format_number(value, digits, factor)


def format_share(value: Interval) -> str:
    """Return a share with its interval in percent; a dash for NaN."""
    if math.isnan(value.value):
        return MISSING
    return f'{100 * value.value:.0f} % ({100 * value.low:.0f} to {100 * value.high:.0f})'


@final
@dataclass(frozen=True, slots=True)
class Column(Generic[Row]):
    """A number or word that every row has."""

    key: str  # name in JSON; '' keeps the column out of it
    # Head of the table, to which the unit is added; None keeps the column out of the table
    head: str | None = None
    unit: str = ''
    digits: int | None = None
    # Returns the value of a row in SI units; by default its attribute `key`
    of: Callable[[Row], Any] | None = None
    factor: float | None = None  # from SI to display units, where `SI_UNITS` lacks the unit
    meaning: str = ''  # shown below the table
    # Returns what the paper states of a row in SI units, or both ends of its range, or nothing
    paper: Callable[[Row], Sequence[float]] | None = None

    def value(self, row: Row) -> Any:
        """Return the value of a row, in SI units."""
        return getattr(row, self.key) if self.of is None else self.of(row)

    def format(self, row: Row) -> str:
        """Return the cell of a row."""
        value = self.value(row)
        # Text that a study has formatted itself, which may be bold
        if isinstance(value, str) and value:
            return value
        return format_value(value, self.digits, self.display_factor)

    @property
    def display_factor(self) -> float:
        """Factor from SI to display units."""
        return unit_factor(self.unit) if self.factor is None else self.factor

    @property
    def title(self) -> str:
        """Head with the unit."""
        return f'{self.head} [{self.unit}]' if self.unit else self.head or ''

    def format_paper(self, row: Row) -> str:
        """Return what the paper states, or its range; a dash if nothing."""
        stated = self.paper(row) if self.paper else ()
        texts = (format_value(each, self.digits, self.display_factor) for each in stated)
        return '\N{EN DASH}'.join(texts) or MISSING

    def compare_with_paper(self) -> 'tuple[Column[Row], ...]':
        """Return the columns of the paper's values and of the ratio to them, if there are any."""
        if self.paper is None:
            return ()
        stated = self.paper

        def find_ratio(row: Row) -> float | None:
            # Of a range in the paper, its middle is compared
            return self.value(row) / fmean(stated(row)) if stated(row) else None

        return (
            Column(f'paper_{self.key}', of=lambda row: list(stated(row))),
            Column('', f'paper [{self.unit}]' if self.unit else 'paper', of=self.format_paper),
            Column('', 'ours / paper', digits=2, of=find_ratio),
        )


def build_table(
    heading: str,
    columns: Iterable[Column[Row]],
    rows: Iterable[Row],
    note: str = '',
    *,
    groups: tuple[tuple[str, int], ...] = (),
    printed: bool = True,
    colors: Mapping[str, CellColor] | None = None,
) -> TextTable:
    """
    Return the table of some rows, as `TextTable` describes it.

    The paper's values stand beside those of their column. The note begins with the meanings.
    """
    visible = [each for each in with_paper(columns) if each.head is not None]
    note = ' '.join([*(f'{c.head}: {c.meaning}.' for c in visible if c.meaning), note]).strip()
    return TextTable(
        heading, [each.title for each in visible],
        [[each.format(row) for each in visible] for row in rows],
        note, groups, printed, colors or {},
    )  # fmt: skip


def with_paper(columns: Iterable[Column[Row]]) -> Iterator[Column[Row]]:
    """Yield columns, each followed by those of the paper's values."""
    for column in columns:
        yield column
        yield from column.compare_with_paper()


def to_record(columns: Iterable[Column[Row]], row: Row) -> dict[str, Any]:
    """Return a row as a JSON object in SI units, with null for NaN and infinity."""
    return {each.key: to_json_value(each.value(row)) for each in with_paper(columns) if each.key}
