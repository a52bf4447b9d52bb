"""Show the progress of a comparison."""

from typing import final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn


@final
class CompareProgress(ProgressBar):
    """Progress bar of a comparison; `total` is the number of calls of `tick`."""

    def __init__(self, console: Console, total: int) -> None:
        columns = (
            TextColumn('{task.description}'),
            BarColumn(),
            TimeRemainingColumn(),
        )
        super().__init__(console, *columns, begin='opening', total=total)

    def tick(self, doing: str) -> None:
        """Show the current step and advance the bar."""
        self.update_bar(description=doing, advance=1)
