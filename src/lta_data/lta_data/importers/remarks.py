"""Count the oddities of a log while it is imported."""

from collections import Counter
from collections.abc import Mapping
from typing import final

from lta_data.importers.log_table import Numbers, Times
import numpy as np


@final
class LogRemarks:
    """Counts irregular times and missing numbers over all parts of a log; data stay unchanged."""

    def __init__(self) -> None:
        self._rows: Counter[str] = Counter()
        self._nan: Counter[str] = Counter()
        self._back: Counter[str] = Counter()
        self._same: Counter[str] = Counter()
        self._last: dict[str, int] = {}
        self._where: dict[str, int] = {}

    def add_rows(self, name: str, stamps: Times, columns: Mapping[str, Numbers]) -> None:
        """Count the next rows of a table: their times, and the columns in use."""
        if not len(stamps):
            return
        # Without an earlier part the first step counts as forward.
        before = self._last.get(name, int(stamps[0]) - 1)
        # Includes the step from the last row of the previous part
        steps = np.diff(stamps, prepend=before)
        self._back[name] += int((steps < 0).sum())
        self._same[name] += int((steps == 0).sum())
        if (steps < 0).any() and name not in self._where:
            # argmax of a mask: the first True; rows count from 1
            self._where[name] = self._rows[name] + int(np.argmax(steps < 0)) + 1
        self._rows[name] += len(stamps)
        self._last[name] = int(stamps[-1])
        for column, numbers in columns.items():
            holes = int(np.isnan(numbers).sum())
            if holes:
                self._nan[f'{name}.{column}' if name else column] += holes

    def format_remarks(self) -> list[str]:
        """Return the remarks, one sentence each."""
        told = []
        for name, count in sorted(self._back.items()):
            if count:
                told.append(
                    f'The time{_format_owner(name)} goes back {_format_times(count)}, first '
                    f'in row {self._where[name]}; these rows are kept.'
                )
        for name, count in sorted(self._same.items()):
            if count:
                told.append(
                    f'The time{_format_owner(name)} repeats {_format_times(count)}; these '
                    'rows are kept.'
                )
        for column, count in sorted(self._nan.items()):
            told.append(
                f"Column '{column}' lacks a number {_format_times(count)}; the bag has NaN there."
            )
        return told


def _format_owner(name: str) -> str:
    return f" of '{name}'" if name else ''


def _format_times(count: int) -> str:
    return 'once' if count == 1 else f'{count} times'
