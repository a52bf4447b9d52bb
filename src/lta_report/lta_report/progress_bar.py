# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The base of progress bars: shown on a terminal while work lasts, else a line each minute."""

import sys
import threading
import time
from typing import Any, Final, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    TextColumn,
    TimeRemainingColumn,
)

LINE_PERIOD: Final = 60.0  # wall s between two lines without a terminal
PACE_SHARE: Final = 0.02  # done, below which the first steps (compiling, loading) tell no pace


class ProgressBar:
    """
    A progress bar: `with ProgressBar(console, BarColumn(), total=3) as bar: ...`.

    Parameters
    ----------
    console : Console
        Output; if it is not a terminal, stderr gets a line each minute.
    columns : ProgressColumn
        Columns after the spinner; description, bar and remaining time by default.
    begin : str
        Initial description.
    total : float, optional
        Amount of work; unknown by default.
    period : float
        Averaging time of the speed. [s]
    fields : Any
        Further fields of the columns.

    """

    def __init__(
        self,
        console: Console,
        *columns: ProgressColumn,
        begin: str = '',
        total: float | None = None,
        period: float = 30.0,
        **fields: Any,
    ) -> None:
        self._console = console
        columns = columns or (
            TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn(),
        )  # fmt: skip
        for column in columns:
            if isinstance(column, TextColumn):
                column.markup = False  # may show the name of an untrusted file
        self._bar = Progress(
            SpinnerColumn(),
            *columns,
            console=console,
            transient=True,  # removed at the end
            # Otherwise rich would interpret escape sequences in what others write meanwhile
            redirect_stdout=False,
            redirect_stderr=False,
            disable=not console.is_terminal,
            speed_estimate_period=period,
        )
        self._task = self._bar.add_task(begin, total=total, **fields)
        # Start and last progress [s], and the share that was complete at the start
        self._begun = self._moved = self._before = 0.0
        self._over = threading.Event()

    def __enter__(self) -> Self:
        """Show the bar."""
        self._before = self._share
        self._begun = self._moved = time.monotonic()
        self._bar.start()
        if not self._console.is_terminal:
            # In a thread of its own, as a step may last for minutes without an update
            threading.Thread(target=self._write_lines, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        """Remove the bar."""
        self._over.set()
        self._bar.stop()

    def _write_lines(self) -> None:
        """Write a line to stderr each minute until the work is over."""
        while not self._over.wait(LINE_PERIOD):
            self.write_line()

    @property
    def _share(self) -> float:
        """Completed share; 0 without a total."""
        task = self._bar.tasks[0]
        return task.completed / task.total if task.total else 0.0

    def write_line(self) -> None:
        """Write the current work to stderr, with its share and the time left as far as known."""
        sys.stderr.write(f'{self._describe()} ...\n')
        sys.stderr.flush()

    def update_bar(self, **change: Any) -> None:
        """Change description, total, completed, or fields; `advance` adds to completed."""
        share, total = self._share, self._bar.tasks[0].total
        self._bar.update(self._task, **change)
        if self._share != share:
            self._moved = time.monotonic()
        if total is None and self._bar.tasks[0].total is not None:
            # What came before is no part of the whole
            self._before, self._begun = self._share, time.monotonic()
            self._moved = self._begun

    def _describe(self) -> str:
        """Return the current work with its share and the time left, as far as known."""
        name, share = self._bar.tasks[0].description, self._share
        if not 0.0 < share < 1.0:
            return name
        text = f'{name}: {100.0 * share:.0f} %'
        # By the pace up to the last progress: a long step without one, such as a compilation, does
        # not make the rest longer. If it lasts longer than all before it, the pace tells nothing.
        done, moving = share - self._before, self._moved - self._begun
        still = time.monotonic() - self._moved
        if done < PACE_SHARE or still > moving:
            return text
        left = (1.0 - share) * moving / done - still
        return f'{text}, about {left / 60.0:.1f} min left' if left > 0.0 else text

    def wait_for(self, what: str) -> None:
        """
        Show a long first step: on the bar, or as a line on stderr without a terminal.

        Standard output stays free for results that other programs read.
        """
        self.update_bar(description=what)
        # Otherwise nothing would show that the program is busy
        if not self._console.is_terminal:
            sys.stderr.write(f'{what} ...\n')
            sys.stderr.flush()

    @property
    def speed(self) -> float | None:
        """Completed amount per second; None while unknown."""
        return self._bar.tasks[0].speed

    def show_message(self, sentence: str) -> None:
        """Print a line above the bar."""
        self._console.print(sentence, highlight=False, soft_wrap=True)
