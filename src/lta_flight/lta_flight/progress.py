# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The progress bar of a flight: distance to the lamp and pace."""

from typing import final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn


@final
class FlightProgress(ProgressBar):
    """
    Show the progress of a flight: `with FlightProgress(console) as progress: ...`.

    `console`: output; nothing is shown if it is not a terminal. `begin`: description before the
    flight begins.
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
        Show the position of the drone.

        `time`: since the start [s]. `distance`: to the lamp [m]. `pace`: flight seconds per wall
        second.
        """
        if self._begin is None:
            # The bar runs from the initial distance to zero
            self._begin = distance
        self.update_bar(
            description='flying',
            total=self._begin,
            # A drone that flies away must not give a negative value
            completed=max(0.0, self._begin - distance),
            detail=f'{distance:.2f} m to the lamp, {time:.1f} s, {pace:.1f} x real time',
        )
