"""The progress bar of a flight: how near the lamp, at what pace, and who is in trouble."""

from types import TracebackType
from typing import final, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn


@final
class FlightProgress:
    """
    Show a flight while it lasts: `with FlightProgress(console) as progress: ...`.

    Parameters
    ----------
    console : Console
        Where to; nothing moves where it is no terminal.
    begin : str
        What happens before the flight.

    """

    def __init__(self, console: Console, begin: str = 'starting the graph') -> None:
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
        self._task = self._bar.add_task(begin, total=None, detail='')
        self._begin: float | None = None

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

    def at(self, time: float, distance: float, pace: float) -> None:
        """
        Show where the drone is.

        Parameters
        ----------
        time : float
            Since the start. [s]
        distance : float
            To the lamp. [m]
        pace : float
            Flight seconds a wall second.

        """
        if self._begin is None:
            self._begin = distance
        self._bar.update(
            self._task,
            description='flying',
            total=self._begin,
            completed=max(0.0, self._begin - distance),
            detail=f'{distance:.2f} m to the lamp, {time:.1f} s, {pace:.1f} x real time',
        )

    def say(self, sentence: str) -> None:
        """Print a line above the bar."""
        self._console.print(sentence, highlight=False, soft_wrap=True)
