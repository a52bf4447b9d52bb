"""Tables of text for the pages about energy, and the same on a terminal."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import final

from rich.console import Console
from rich.table import Table as Printed
from rich.text import Text


@final
@dataclass(frozen=True, slots=True)
class TextTable:
    """A heading, the heads of its columns, and its rows; the first cell of a row names it."""

    heading: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ''


def transpose_table(table: TextTable) -> TextTable:
    """Return a table with rows and columns exchanged, for a narrow terminal."""
    rows = [
        [head, *(row[place] for row in table.rows)]
        for place, head in enumerate(table.heads[1:], start=1)
    ]
    heads = [table.heads[0], *(row[0] for row in table.rows)]
    return TextTable(table.heading, heads, rows, table.note)


def render_text_table(table: TextTable) -> str:
    """Return a table in a panel of its own."""
    head = ''.join(f'<th scope="col">{escape(each)}</th>' for each in table.heads)
    lines = []
    for first, *rest in table.rows:
        cells = ''.join(f'<td>{escape(cell)}</td>' for cell in rest)
        lines.append(f'<tr><th scope="row">{escape(first)}</th>{cells}</tr>')
    words = escape(table.heading)
    note = f'<p class="note">{escape(table.note)}</p>' if table.note else ''
    return (
        f'<section class="panel told" aria-label="{words}"><h2>{words}</h2>'
        f'<div class="wide"><table><caption class="hidden">{words}</caption>'
        f'<thead><tr>{head}</tr></thead><tbody>{"".join(lines)}</tbody></table></div>'
        f'{note}</section>'
    )


def print_table(table: TextTable, console: Console) -> None:
    """Print a table; it moves together where the terminal is narrow."""
    # Heads a word a line: a column is as wide as its numbers.
    heads = [head.replace(' ', '\n') for head in table.heads]
    columns = zip(heads, *table.rows, strict=True)
    width = sum(max(len(line) for cell in each for line in cell.split('\n')) for each in columns)
    gap = 2 if width + 2 * len(heads) <= console.width else 1
    printed = Printed(
        title=table.heading, title_justify='left', title_style='bold', box=None, pad_edge=False,
        padding=(0, gap, 0, 0),
    )  # fmt: skip
    for place, (head, *cells) in enumerate(zip(heads, *table.rows, strict=True)):
        words = place > 0 and any(' ' in cell for cell in cells)
        printed.add_column(
            Text(head), justify='left' if place == 0 else 'right', no_wrap=not words
        )
    for row in table.rows:
        printed.add_row(*map(Text, row))
    console.print(printed)
    if table.note:
        console.print(table.note, style='dim', highlight=False, markup=False)
    console.print()
