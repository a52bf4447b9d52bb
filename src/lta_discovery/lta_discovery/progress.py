# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Progress bar of a discovery: its stage, and how far it is."""

from typing import Final, final

from lta_report.progress_bar import ProgressBar
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn

SAID: Final = 60  # most characters of a stage's description


@final
class DiscoverProgress(ProgressBar):
    """Show the progress of a discovery; on a non-terminal nothing is animated."""

    def __init__(self, console: Console) -> None:
        columns = (
            TextColumn('{task.description}'),
            BarColumn(),
            TimeElapsedColumn(),
        )
        super().__init__(console, *columns, begin='reading', total=None)

    def show_stage(self, words: str, share: float | None = None) -> None:
        """
        Show the current stage.

        `share`: completed part of the whole, 0 to 1; the bar only pulses without it.
        """
        if share is None:
            self.update_bar(description=words[:SAID])
        else:
            self.update_bar(description=words[:SAID], total=1.0, completed=share)
