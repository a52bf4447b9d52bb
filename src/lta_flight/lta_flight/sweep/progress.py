"""The progress bar of a sweep: flights, rate, remaining time and outcomes."""

from collections import Counter
import time
from types import TracebackType
from typing import final

from lta_flight.sweep.job_runner import SweepRow
from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    TextColumn,
    TimeRemainingColumn,
)

LOOK = 0.1  # wall s between two updates of the bar
RECENT = 60.0  # s over which the rate is averaged


@final
class SweepProgress(ProgressBar):
    """
    Show the progress of a sweep.

    Parameters
    ----------
    console : Console
        Output; nothing is shown if it is not a terminal.
    total, done : int
        Number of flights, and of those already flown.

    """

    def __init__(self, console: Console, total: int, done: int) -> None:
        super().__init__(
            console,
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn('{task.fields[rate]}'),
            TimeRemainingColumn(),
            TextColumn('{task.fields[detail]}'),
            total=total,
            completed=done,
            period=RECENT,
            rate='',
            detail='',
        )
        self._counts: Counter[str] = Counter()
        # `_shown` starts in the past, so that the first flight is shown at once
        self._pending, self._deaths, self._shown = 0, 0, -LOOK

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Update the bar a last time and remove it."""
        self._update_bar()
        super().__exit__(kind, error, trace)

    def count_flight(self, row: SweepRow, deaths: int) -> None:
        """Count a flight; `deaths` is the number of workers lost so far."""
        self._counts[row.outcome] += 1
        self._pending += 1
        self._deaths = deaths
        if time.monotonic() - self._shown >= LOOK:
            self._update_bar()

    def _update_bar(self) -> None:
        """Advance the bar by the flights counted since the last update."""
        self._shown = time.monotonic()
        words = [f'{count} {outcome}' for outcome, count in sorted(self._counts.items())]
        if self._deaths:
            words.append(f'{self._deaths} workers lost')
        self.update_bar(advance=self._pending, detail=', '.join(words))
        self._pending = 0
        if self.speed:
            self.update_bar(rate=f'{self.speed:.1f} flights/s')
