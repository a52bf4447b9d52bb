"""The progress bar of a tuning: candidates, flights, the best cost, and what comes after."""

from typing import final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    TextColumn,
    TimeRemainingColumn,
)


@final
class TuneProgress(ProgressBar):
    """
    Show a tuning while it lasts.

    Parameters
    ----------
    console : Console
        Where to; nothing moves where it is no terminal.
    budget, cases : int
        Candidates, and examinations of each.

    """

    def __init__(self, console: Console, budget: int, cases: int) -> None:
        self._cases = cases
        super().__init__(
            console,
            TextColumn('candidates'),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            TextColumn('{task.fields[detail]}'),
            total=budget,
            detail='',
        )
        console.print(
            f'{budget} candidates with {cases} examinations each: {budget * cases} flights.',
            highlight=False,
        )

    def show_candidate(self, count: int, best: float) -> None:
        """Count one more candidate."""
        words = f'{count * self._cases} flights, best cost {best:.3f}'
        self.update_bar(completed=count, detail=words)

    def show_stage(self, words: str) -> None:
        """Say what is done after the search."""
        self.update_bar(detail=words)
