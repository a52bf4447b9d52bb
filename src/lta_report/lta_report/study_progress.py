"""The progress bar of a study: items, share, elapsed and remaining time, rate and outcomes."""

from collections import Counter
import time
from typing import Final, final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

BAR_PERIOD: Final = 0.1  # wall s between two updates of the bar
RECENT: Final = 60.0  # s over which the rate is averaged


@final
class StudyProgress(ProgressBar):
    """
    Show the progress of a study.

    `console`: output; nothing is shown if it is not a terminal. `total`, `done`: number of items,
    and of those already finished. `unit`: what the items are, such as 'flights'.
    """

    def __init__(self, console: Console, total: int, done: int = 0, unit: str = 'items') -> None:
        super().__init__(
            console,
            TextColumn('{task.description}'),
            BarColumn(),
            MofNCompleteColumn(),
            # The first item may take minutes, in which only these two tell that it goes on
            TextColumn('{task.percentage:.0f} % after'),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            TextColumn('left'),
            TextColumn('{task.fields[rate]}'),
            TextColumn('{task.fields[detail]}'),
            begin=unit,
            total=total,
            completed=done,
            period=RECENT,
            rate='',
            detail='',
        )
        self._unit, self._done, self._part, self._lost = unit, done, 0.0, 0
        self._counts: Counter[str] = Counter()
        self._detail = ''
        self._shown_at = -BAR_PERIOD  # in the past, so that the first item is shown at once

    def __exit__(self, *_: object) -> None:
        """Update the bar a last time and remove it."""
        self._update()
        super().__exit__()

    def skip_items(self, count: int) -> None:
        """Count items as finished before the work begins."""
        self._done += count
        self.update_bar(completed=self._done)

    def count_item(self, word: str = '', lost: int = 0) -> None:
        """Count an item under a word; `lost` is the number of workers that died so far."""
        self._done += 1
        self._part = 0.0
        self._lost = lost
        if word:
            self._counts[word] += 1
        self._update_sometimes()

    def show_detail(self, words: str) -> None:
        """Show words after the counts."""
        self._detail = words
        self._update_sometimes()

    def show_part(self, part: float) -> None:
        """Show the finished share of the current items, added up."""
        self._part = part
        self._update_sometimes()

    def _update_sometimes(self) -> None:
        # A batch finishes thousands of items at once
        if time.monotonic() - self._shown_at >= BAR_PERIOD:
            self._update()

    def _update(self) -> None:
        self._shown_at = time.monotonic()
        words = [f'{count} {word}' for word, count in sorted(self._counts.items())]
        if self._lost:
            words.append(f'{self._lost} workers lost')
        if self._detail:
            words.append(self._detail)
        self.update_bar(completed=self._done + self._part, detail=', '.join(words))
        if self.speed and self.speed >= 0.1:
            self.update_bar(rate=f'{self.speed:.1f} {self._unit}/s')
