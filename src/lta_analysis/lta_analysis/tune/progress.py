"""The progress bar of a tuning: candidates, flights, the best cost, and what comes after."""

from types import TracebackType
from typing import final, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeRemainingColumn,
)


@final
class TuneProgress:
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
        self._bar = Progress(
            SpinnerColumn(),
            TextColumn('candidates'),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            TextColumn('{task.fields[detail]}'),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task('', total=budget, detail='')
        console.print(
            f'{budget} candidates with {cases} examinations each: {budget * cases} flights.',
            highlight=False,
        )

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

    def candidate(self, count: int, best: float) -> None:
        """Count one more candidate."""
        words = f'{count * self._cases} flights, best cost {best:.3f}'
        self._bar.update(self._task, completed=count, detail=words)

    def stage(self, words: str) -> None:
        """Say what is done after the search."""
        self._bar.update(self._task, detail=words)
