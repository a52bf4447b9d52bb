"""Show a progress bar for studies with many flights."""

from collections.abc import Callable
from typing import TypeVar

from rich.console import Console
from rich.progress import Progress

Result = TypeVar('Result')


def run_with_progress(
    work: Callable[[Callable[[], None]], Result], todo: int, console: Console
) -> Result:
    """Run `work` with a callback that advances a bar of `todo` flights."""
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        # On anything but a terminal the bar is off, as it would fill a log.
        task = progress.add_task('flying', total=todo)
        return work(lambda: progress.advance(task))
