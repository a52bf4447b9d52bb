"""The progress bar of an export: which topic, how many still."""

from types import TracebackType
from typing import final, Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn


@final
class ExportProgress:
    """
    Show an export while it lasts.

    Parameters
    ----------
    console : Console
        Where to; nothing moves where it is no terminal.

    """

    def __init__(self, console: Console) -> None:
        self._bar = Progress(
            SpinnerColumn(),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn('{task.description}'),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task('reading', total=None)

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

    def at(self, topic: str, done: int, total: int) -> None:
        """Show the topic that is written."""
        self._bar.update(self._task, description=topic, completed=done, total=total)
