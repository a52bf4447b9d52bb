"""Show the progress of an export."""

from typing import final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn


@final
class ExportProgress(ProgressBar):
    """Progress bar of an export, with the current topic."""

    def __init__(self, console: Console) -> None:
        columns = (
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn('{task.description}'),
        )
        super().__init__(console, *columns, begin='reading')

    def show_topic(self, topic: str, done: int, total: int) -> None:
        """Show the topic that is being written."""
        self.update_bar(description=topic, completed=done, total=total)
