"""The progress bar of a replay, and what it says above it."""

from types import TracebackType
from typing import final, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn


@final
class ReplayProgress:
    """
    Show a replay while it lasts: `with ReplayProgress(console, 60.0) as progress: ...`.

    Parameters
    ----------
    console : Console
        Where to; nothing moves where it is no terminal.
    length : float
        Of the recording. [s]

    """

    def __init__(self, console: Console, length: float) -> None:
        self._console = console
        self._bar = Progress(
            SpinnerColumn(),
            TextColumn('{task.description}'),
            BarColumn(),
            TextColumn('{task.fields[detail]}'),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task('starting the nodes', total=length, detail='')

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

    def at(self, time: float, pace: float) -> None:
        """Show how far the replay is: bag time [s] and bag seconds a wall second."""
        detail = f'{time:.1f} s, {pace:.1f} x real time'
        self._bar.update(self._task, description='replaying', completed=time, detail=detail)

    def say(self, sentence: str) -> None:
        """Print a line above the bar."""
        self._console.print(sentence, highlight=False, soft_wrap=True)
