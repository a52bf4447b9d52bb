"""The progress bar of a replay."""

from typing import final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn


@final
class ReplayProgress(ProgressBar):
    """
    Show the progress of a replay: `with ReplayProgress(console, 60.0) as progress: ...`.

    `console`: output; nothing is shown if it is not a terminal. `length`: duration of the
    recording [s].
    """

    def __init__(self, console: Console, length: float) -> None:
        detail = TextColumn('{task.fields[detail]}')
        columns = (TextColumn('{task.description}'), BarColumn(), detail)
        super().__init__(console, *columns, begin='starting the nodes', total=length, detail='')

    def show_progress(self, time: float, pace: float) -> None:
        """Show bag time [s] and bag seconds per wall second."""
        detail = f'{time:.1f} s, {pace:.1f} x real time'
        self.update_bar(description='replaying', completed=time, detail=detail)
