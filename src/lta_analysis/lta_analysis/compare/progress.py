"""The progress bar of a comparison."""

from types import TracebackType
from typing import final, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeRemainingColumn


@final
class CompareProgress:
    """
    Show a comparison while it lasts.

    Parameters
    ----------
    console : Console
        Where to; nothing moves where it is no terminal.
    total : int
        How often `tick` will be called.

    """

    def __init__(self, console: Console, total: int) -> None:
        self._bar = Progress(
            SpinnerColumn(), TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn(),
            console=console, transient=True, disable=not console.is_terminal,
        )  # fmt: skip
        self._task = self._bar.add_task('opening', total=total)

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

    def tick(self, doing: str) -> None:
        """Say what is being done, and go on."""
        self._bar.update(self._task, description=doing, advance=1)
