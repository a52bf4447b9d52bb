"""The progress bar of an import: how much of which log has been read."""

import time
from typing import final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn

LOOK = 0.1  # wall s between two movements of the bar


@final
class ImportProgress(ProgressBar):
    """
    Show an import while it lasts.

    Parameters
    ----------
    console : Console
        Where to; nothing moves where it is no terminal.
    total : int
        Logs to import.

    """

    def __init__(self, console: Console, total: int) -> None:
        columns = (TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn())
        super().__init__(console, *columns, total=float(total))
        self._done = 0
        self._shown = -LOOK

    def begin_log(self, name: str) -> None:
        """Show which log is read now."""
        self.update_bar(description=name)

    def show_fraction(self, part: float) -> None:
        """Show how much of it has been read, from 0 to 1."""
        now = time.monotonic()
        if now - self._shown >= LOOK:
            self._shown = now
            self.update_bar(completed=self._done + part)

    def end_log(self) -> None:
        """Show that it is done."""
        self._done += 1
        self.update_bar(completed=float(self._done))
