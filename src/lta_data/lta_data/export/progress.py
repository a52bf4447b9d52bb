"""The progress bar of an export: which topic, how many still."""

from typing import final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn


@final
class ExportProgress(ProgressBar):
    """
    Show an export while it lasts.

    Parameters
    ----------
    console : Console
        Where to; nothing moves where it is no terminal.

    """

    def __init__(self, console: Console) -> None:
        columns = (
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn('{task.description}'),
        )
        super().__init__(console, *columns, begin='reading')

    def show_topic(self, topic: str, done: int, total: int) -> None:
        """Show the topic that is written."""
        self.update_bar(description=topic, completed=done, total=total)
