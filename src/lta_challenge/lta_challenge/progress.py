"""Define the progress bar and the option --jobs of the challenge commands."""

from typing import Annotated

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
import typer

Jobs = Annotated[
    int | None, typer.Option(help='Number of worker processes; default: one per processor.', min=1)
]


def challenge_bar(console: Console, words: str, total: int) -> ProgressBar:
    """Return a progress bar; without a terminal it prints a line every ten minutes."""
    columns = (TextColumn('{task.description}'), BarColumn(), MofNCompleteColumn())
    return ProgressBar(
        console, *columns, TimeRemainingColumn(), begin=words, total=total, period=600.0
    )
