# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The console on which studies and commands print; it is the only one that does."""

from collections.abc import Iterator
import os
from typing import final

from lta_config.errors import strip_control_codes
from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

UNLIMITED = 10_000  # columns; wider than any table


@final
class PlainConsole(Console):
    """A console whose texts have no control characters; those of its styles remain."""

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterator[Segment]:
        """Yield the segments of a renderable."""
        for text, style, control in super().render(renderable, options):
            yield Segment(text if control else strip_control_codes(text), style, control)


def plain_console(stderr: bool = False) -> Console:
    """
    Return a console that does not interpret markup.

    Names in recordings and files may contain text that rich takes for a style, and an unknown
    style raises an error. Into a file or a pipe, a table takes the width that it needs.
    """
    console = PlainConsole(stderr=stderr, markup=False, emoji=False)
    if not console.is_terminal and 'COLUMNS' not in os.environ:
        console.width = UNLIMITED
    return console


def print_lines(console: Console, *lines: str, style: str | None = None) -> None:
    """Print lines as they are, however long they are."""
    for line in lines:
        console.print(line, style=style, highlight=False, markup=False, soft_wrap=True)
