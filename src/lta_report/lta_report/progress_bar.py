"""What all progress bars share: they show while something lasts, and only to a person."""

import sys
from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.progress import Progress, ProgressColumn, SpinnerColumn, TextColumn


class ProgressBar:
    """
    A progress bar: `with Bar(console, BarColumn(), total=3) as bar: bar.move(advance=1)`.

    Parameters
    ----------
    console : Console
        Where to; nothing moves where it is no terminal.
    columns : ProgressColumn
        What stands behind the spinner.
    begin : str
        Description at the beginning.
    total : float, optional
        What there is to do; unknown by default.
    period : float
        Over which the speed is estimated. [s]
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
        **fields: Any,  # noqa: ANN401 - as rich takes them
    ) -> None:
        self._console = console
        for column in columns:
            if isinstance(column, TextColumn):
                column.markup = False  # what it shows may be the name of a stranger's file
        self._bar = Progress(
            SpinnerColumn(),
            *columns,
            console=console,
            transient=True,
            disable=not console.is_terminal,
            speed_estimate_period=period,
        )
        self._task = self._bar.add_task(begin, total=total, **fields)

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

    def update_bar(self, **change: Any) -> None:  # noqa: ANN401 - as rich takes them
        """Change description, total, completed, or fields; `advance` adds to what is done."""
        self._bar.update(self._task, **change)

    def wait_for(self, what: str) -> None:
        """
        Show what lasts before anything moves: on the bar, or as a line where there is none.

        The line goes to stderr: what a program prints for others stays as they expect it.
        """
        self.update_bar(description=what)
        if not self._console.is_terminal:
            sys.stderr.write(f'{what} ...\n')
            sys.stderr.flush()

    @property
    def speed(self) -> float | None:
        """How much is done a second; None before that is known."""
        return self._bar.tasks[0].speed

    def show_message(self, sentence: str) -> None:
        """Print a line above the bar."""
        self._console.print(sentence, highlight=False, soft_wrap=True)
