"""Show the progress of a tuning: candidates, flights, best cost and the stages after it."""

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
    """Progress bar of a tuning with `budget` candidates of `cases` test flights each."""

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
            f'{budget} candidates with {cases} test flights each: {budget * cases} flights.',
            highlight=False,
        )

    def show_candidate(self, count: int, best: float) -> None:
        """Count one more candidate."""
        # `count` is the number of candidates, each with several flights.
        words = f'{count * self._cases} flights, best cost {best:.3f}'
        self.update_bar(completed=count, detail=words)

    def show_stage(self, words: str) -> None:
        """Show the stage after the search."""
        self.update_bar(detail=words)
