"""The progress bar of a discovery: which stage, and how far it is."""

from typing import Final, final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn

SAID: Final = 60  # characters of a stage


@final
class DiscoverProgress(ProgressBar):
    """
    Show a discovery while it lasts.

    Parameters
    ----------
    console : Console
        Where to; nothing moves where it is no terminal.

    """

    def __init__(self, console: Console) -> None:
        columns = (
            TextColumn('{task.description}'),
            BarColumn(),
            TimeElapsedColumn(),
        )
        super().__init__(console, *columns, begin='reading', total=None)

    def show_stage(self, words: str, share: float | None = None) -> None:
        """
        Say what is being done.

        Parameters
        ----------
        words : str
            The stage.
        share : float, optional
            Of the whole, 0 to 1; without it the bar only moves.

        """
        if share is None:
            self.update_bar(description=words[:SAID])
        else:
            self.update_bar(description=words[:SAID], total=1.0, completed=share)
