"""Show the progress of an import."""

import time
from typing import final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn

LOOK = 0.1  # s of wall time between two updates of the bar


@final
class ImportProgress(ProgressBar):
    """Progress bar of an import; `total` is the number of logs."""

    def __init__(self, console: Console, total: int) -> None:
        columns = (TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn())
        super().__init__(console, *columns, total=float(total))
        self._done = 0
        self._shown_at = -LOOK

    def begin_log(self, name: str) -> None:
        """Show which log is being read."""
        self.update_bar(description=name)

    def show_fraction(self, part: float) -> None:
        """Show the fraction of it that has been read, 0 to 1."""
        now = time.monotonic()
        if now - self._shown_at >= LOOK:
            self._shown_at = now
            self.update_bar(completed=self._done + part)

    def end_log(self) -> None:
        """Mark the log as done."""
        self._done += 1
        self.update_bar(completed=float(self._done))
