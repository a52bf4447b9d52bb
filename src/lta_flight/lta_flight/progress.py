"""The progress bar of a flight: how near the lamp, at what pace, and who is in trouble."""

from typing import final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn


@final
class FlightProgress(ProgressBar):
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
        detail = TextColumn('{task.fields[detail]}')
        super().__init__(
            console,
            TextColumn('{task.description}'),
            BarColumn(),
            detail,
            begin=begin,
            detail='',
        )
        self._begin: float | None = None

    def show_position(self, time: float, distance: float, pace: float) -> None:
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
        self.update_bar(
            description='flying',
            total=self._begin,
            completed=max(0.0, self._begin - distance),
            detail=f'{distance:.2f} m to the lamp, {time:.1f} s, {pace:.1f} x real time',
        )
