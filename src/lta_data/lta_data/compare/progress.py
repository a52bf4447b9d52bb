"""The progress bar of a comparison."""

from typing import final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn


@final
class CompareProgress(ProgressBar):
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
        columns = (
            TextColumn('{task.description}'),
            BarColumn(),
            TimeRemainingColumn(),
        )
        super().__init__(console, *columns, begin='opening', total=total)

    def tick(self, doing: str) -> None:
        """Say what is being done, and go on."""
        self.update_bar(description=doing, advance=1)
