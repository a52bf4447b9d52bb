# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Define the interface of log readers: tables of numbers, and messages to pass on unchanged."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import final, NamedTuple, Protocol
from zlib import crc32

from lta_bag.metadata import OfferedQos
from lta_bag.schemas import MessageDefinition
import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
Times = NDArray[np.int64]


@final
@dataclass(frozen=True, slots=True)
class LogTable:
    """Rows of a log, in the order of the log."""

    # Time of measurement and time of logging, shape (n,) [ns]
    stamps: Times
    log_times: Times
    # Position of a row in the log, or its time if unknown; orders the rows of several tables,
    # shape (n,)
    order: Times
    columns: Mapping[str, Numbers]  # numbers as logged; NaN if missing, shape (n,)
    # Mask of the empty cells, for columns that have some, shape (n,)
    empty: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.stamps)

    def select_rows(self, rows: NDArray[np.bool_]) -> 'LogTable':
        """Return some of the rows."""
        if rows.all():
            return self
        return LogTable(
            self.stamps[rows],
            self.log_times[rows],
            self.order[rows],
            {name: column[rows] for name, column in self.columns.items()},
            {name: holes[rows] for name, holes in self.empty.items()},
        )


def encode_label(word: str) -> float:
    """Return a number for a word that selects rows, the same wherever it stands."""
    return float(crc32(word.strip().encode()))


def join_tables(table: LogTable, others: Mapping[str, LogTable]) -> tuple[LogTable, int]:
    """
    Add the columns of other tables as `other.column`, with the latest values before each row.

    Values are not interpolated; before the other's first row they are NaN.

    Returns
    -------
    LogTable
        With as many rows as `table`.
    int
        The largest age of a joined value. [ns]

    """
    columns = dict(table.columns)
    oldest = 0
    for name, other in others.items():
        order = np.argsort(other.stamps, kind='stable')
        # Never a later row: an onboard program could not know it either.
        at = np.searchsorted(other.stamps[order], table.stamps, side='right') - 1
        has_match = at >= 0
        rows = order[np.maximum(at, 0)] if len(order) else np.zeros(len(table), dtype=np.intp)
        for column, numbers in other.columns.items():
            taken = numbers[rows] if len(order) else np.full(len(table), np.nan)
            columns[f'{name}.{column}'] = np.where(has_match, taken, np.nan)
        if has_match.any():
            oldest = max(oldest, int((table.stamps - other.stamps[rows])[has_match].max()))
    return replace(table, columns=columns), oldest


Reached = Callable[[float], None]  # called with the fraction of the log read so far, 0 to 1


@final
class PassThroughMessage(NamedTuple):
    """A message passed on unchanged: position in the log, its topic, log time in ns, and CDR."""

    order: int
    topic: str
    log_time: int
    data: bytes


@final
@dataclass(frozen=True, slots=True)
class RawTopic:
    """A topic of a bag: its definition and the offered quality of service."""

    definition: MessageDefinition
    qos: Sequence[OfferedQos] = ()


class LogReader(Protocol):
    """An opened log."""

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """Return the columns of each table; a format with a single table names it ''."""
        ...

    @property
    def raw(self) -> Mapping[str, RawTopic]:
        """Topics whose messages can be passed on unchanged; empty if a format has none."""
        ...

    @property
    def notes(self) -> list[str]:
        """Remarks on missing or odd data, one sentence each; grows while the log is read."""
        ...

    @property
    def facts(self) -> dict[str, str]:
        """Return the log's own provenance."""
        ...

    @property
    def timed(self) -> Sequence[str]:
        """Columns that were used as times."""
        ...

    def read_tables(self, selection: Mapping[str, Collection[str]]) -> Mapping[str, LogTable]:
        """Return the selected tables, with the selected columns at least; all if none is."""
        ...

    def iterate_messages(self, reached: Reached) -> Iterator[PassThroughMessage]:
        """Yield all messages of `raw` in the order of recording."""
        ...


@final
@dataclass(slots=True)
class InMemoryLog:
    """A log whose tables are read on opening."""

    content: Mapping[str, LogTable]
    notes: list[str]
    facts: dict[str, str]
    raw: Mapping[str, RawTopic] = field(default_factory=dict)
    timed: Sequence[str] = ('timestamp_sample',)

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """Return the columns of each table."""
        return {name: list(table.columns) for name, table in self.content.items()}

    def read_tables(self, selection: Mapping[str, Collection[str]]) -> Mapping[str, LogTable]:
        """Return the selected tables."""
        return {name: self.content[name] for name in selection}

    def iterate_messages(self, reached: Reached) -> Iterator[PassThroughMessage]:
        """Yield nothing: these logs contain no ROS messages."""
        yield from ()
