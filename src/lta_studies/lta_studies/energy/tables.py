"""Render text tables in HTML and on a terminal."""

from html import escape

from lta_report.report import TextTable
from rich.console import Console
from rich.table import Table as Printed
from rich.text import Text


def render_text_table(table: TextTable) -> str:
    """Return a table in its own HTML panel."""
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
    """Print a table, with narrower gaps if the terminal is narrow."""
    # One word per line in the heads, so that columns are as narrow as their numbers.
    heads = [head.replace(' ', '\n') for head in table.heads]
    columns = zip(heads, *table.rows, strict=True)
    width = sum(max(len(line) for cell in each for line in cell.split('\n')) for each in columns)
    # Columns are separated by 2 spaces, or by 1 if the table would not fit.
    gap = 2 if width + 2 * len(heads) <= console.width else 1
    printed = Printed(
        title=table.heading, title_justify='left', title_style='bold', box=None, pad_edge=False,
        padding=(0, gap, 0, 0),
    )  # fmt: skip
    for place, (head, *cells) in enumerate(zip(heads, *table.rows, strict=True)):
        # Only columns of words may wrap; a wrapped number is unreadable.
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
