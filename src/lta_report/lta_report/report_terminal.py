# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Print a report on a terminal."""

from collections.abc import Sequence
from dataclasses import replace
from textwrap import wrap
from typing import Final

from lta_report.report import (
    Block,
    CellColor,
    Emphasis,
    Grid,
    Report,
    ReportSection,
    TextSection,
    TextTable,
    transpose_table,
)
from lta_report.report_page import is_numeric
from rich.console import Console
from rich.table import Table
from rich.text import Text

COLUMN_GAP = 2  # spaces between columns; 1 if the terminal is narrow
CELL_STYLES: Final[dict[CellColor, str]] = {'good': 'green', 'bad': 'yellow', 'soft': 'dim'}
LONGEST_ROW_NAME = 24  # characters to which long names wrap before a table is printed in parts


def print_report(report: Report, console: Console) -> None:
    """Print tables and notes, then the headline and the closing lines."""
    for block in report.blocks:
        print_block(block, console)
    for line in (report.headline, *report.closing):
        console.print(line, highlight=False, markup=False, soft_wrap=True)


def print_block(block: Block, console: Console) -> None:
    """Print one block; pictures are on the page only."""
    match block:
        case TextTable(printed=True):
            print_table(block, console)
        case TextSection(printed=True):
            console.print(
                '\n'.join(block.paragraphs), highlight=False, markup=False, soft_wrap=True
            )
            console.print()
        case Grid() | ReportSection(folded=False):
            for each in block.blocks:
                print_block(each, console)
        case _:
            pass


def print_table(table: TextTable, console: Console) -> None:
    """Print a table: with narrower gaps, transposed or in parts where the terminal is narrow."""
    table = merge_groups(table)
    gap = COLUMN_GAP
    if not console.is_terminal:
        # Into a file or a pipe, a table takes the width that it needs
        console.width = max(console.width, measure_width(table, gap))
    elif measure_width(table, COLUMN_GAP) > console.width:
        gap = 1
        turned = transpose_table(table)
        fits = measure_width(table, gap) > console.width >= measure_width(turned, gap)
        # Of a table with more rows than columns, the names wrap instead
        if fits and len(table.rows) < len(table.heads):
            table = turned
    for part in split_table(table, console.width, gap):
        console.print(draw_table(part, gap, wraps=measure_width(part, gap) > console.width))
    if table.note:
        console.print(table.note, style='dim', highlight=False, markup=False, soft_wrap=True)
    console.print()


def draw_table(table: TextTable, gap: int, *, wraps: bool) -> Table:
    """Return a table for the terminal; with `wraps`, columns of words and names may wrap."""
    grid = Table(
        title=table.heading, title_justify='left', title_style='bold', box=None, pad_edge=False,
        padding=(0, gap, 0, 0),
    )  # fmt: skip
    for place, (head, *cells) in enumerate(zip(split_heads(table), *table.rows, strict=True)):
        # A wrapped number is unreadable
        words = place == 0 or not is_numeric(cells)
        grid.add_column(
            Text(head), justify='left' if words else 'right', overflow='fold',
            no_wrap=not (wraps and words),
        )  # fmt: skip
    for row in table.rows:
        grid.add_row(*(style_cell(cell, table.colors.get(cell)) for cell in row))
    return grid


def split_table(table: TextTable, width: int, gap: int) -> list[TextTable]:
    """Return the parts of a table that fit a width, each with the column of names."""
    first, *sizes = measure_columns(table)
    parts, taken = [[0]], first
    for place, size in enumerate(sizes, start=1):
        if taken + gap + size > width and len(parts[-1]) > 1:
            parts.append([0])
            taken = first
        parts[-1].append(place)
        taken += gap + size
    return [
        TextTable(
            '' if number else table.heading,
            [table.heads[place] for place in part],
            [[row[place] for place in part] for row in table.rows],
            colors=table.colors,
        )
        for number, part in enumerate(parts)
    ]


def measure_columns(table: TextTable) -> list[int]:
    """Return the smallest width of each column: names and words may wrap, numbers may not."""
    widths = []
    for place, (head, *cells) in enumerate(zip(split_heads(table), *table.rows, strict=True)):
        own = measure_lines(cells)
        if place == 0:
            own = min(own, LONGEST_ROW_NAME)
        elif not is_numeric(cells):
            own = measure_lines([cell.replace(' ', '\n') for cell in cells])
        widths.append(max(own, measure_lines([head])))
    return widths


def measure_lines(cells: Sequence[str]) -> int:
    """Return the length of the longest line of some cells."""
    return max((len(line) for cell in cells for line in cell.split('\n')), default=0)


def style_cell(cell: str, color: CellColor | None = None) -> Text:
    """Return the text of a cell."""
    bold = 'bold' if isinstance(cell, Emphasis) else ''
    return Text(cell, style=CELL_STYLES[color] if color else bold)


def merge_groups(table: TextTable) -> TextTable:
    """Return a table with one row of heads, each after the name of its group."""
    names = [name for name, span in table.groups for _ in range(span)]
    if not names:
        return table
    heads = [f'{name} {head}'.strip() for name, head in zip(names, table.heads, strict=True)]
    return replace(table, heads=heads, groups=())


def split_heads(table: TextTable) -> list[str]:
    """Return the heads, in lines that are as wide as the cells below; words stay whole."""
    cells = zip(*table.rows, strict=True) if table.rows else [()] * len(table.heads)
    widths = [max(map(len, each), default=0) for each in cells]
    return [
        '\n'.join(wrap(head, max(width, 1), break_long_words=False, break_on_hyphens=False))
        for head, width in zip(table.heads, widths, strict=True)
    ]


def measure_width(table: TextTable, gap: int) -> int:
    """Return the number of characters of the widest line of a table."""
    widths = [measure_lines(each) for each in zip(split_heads(table), *table.rows, strict=True)]
    return sum(widths) + gap * (len(widths) - 1)
