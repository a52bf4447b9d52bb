# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Format numbers with units and tables in Markdown, and define the tiles of a page."""

from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

MISSING: Final = '\N{EN DASH}'


class Tile(NamedTuple):
    """One large number: name, value, unit and note."""

    name: str
    value: str
    unit: str
    note: str


def format_number(value: float | None, digits: int = 2, factor: float = 1.0) -> str:
    """Return a number with fixed digits and a typographic minus sign."""
    if value is None:
        return MISSING
    text = f'{value * factor:.{digits}f}'
    # Do not print -0.00
    if float(text) == 0.0:
        text = text.removeprefix('-')
    # The true minus sign is as wide as a plus
    return text.replace('-', '\N{MINUS SIGN}')


def format_amount(value: float | None, unit: str, digits: int = 2, factor: float = 1.0) -> str:
    """Return a number with its unit."""
    if value is None:
        return MISSING
    # No space before a degree sign
    gap = '' if unit.startswith('°') else ' '
    return f'{format_number(value, digits, factor)}{gap}{unit}'


def format_markdown_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [heads, ['---'] * len(heads), *rows]
    return '\n'.join(f'| {" | ".join(cells)} |' for cells in lines)
