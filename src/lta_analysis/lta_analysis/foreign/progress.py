"""The progress bar of an import: how much of which log has been read."""

import time
from types import TracebackType
from typing import final, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeRemainingColumn

LOOK = 0.1  # wall s between two movements of the bar


@final
class ImportProgress:
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
        self._bar = Progress(
            SpinnerColumn(),
            TextColumn('{task.description}'),
            BarColumn(),
            TimeRemainingColumn(),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task('', total=float(total))
        self._done = 0
        self._shown = -LOOK

    def __enter__(self) -> Self:
        """Show the bar."""
        self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Take the bar away."""
        self._bar.stop()

    def begin(self, name: str) -> None:
        """Show which log is read now."""
        self._bar.update(self._task, description=name)

    def reached(self, part: float) -> None:
        """Show how much of it has been read, from 0 to 1."""
        now = time.monotonic()
        if now - self._shown >= LOOK:
            self._shown = now
            self._bar.update(self._task, completed=self._done + part)

    def end(self) -> None:
        """Show that it is done."""
        self._done += 1
        self._bar.update(self._task, completed=float(self._done))
