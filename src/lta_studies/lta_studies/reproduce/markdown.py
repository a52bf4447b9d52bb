"""The reproduction as docs/paper.md."""

from collections.abc import Sequence
from typing import Final

from lta_config.schema.paper_file import PaperRow
from lta_studies.reproduce import lines
from lta_studies.reproduce.kept import Kept
from lta_studies.reproduce.lines import Kepts, Lines

HEAD: Final = """# The paper, reproduced

`./lta reproduce` runs every experiment of the paper (Huang, Xu and Zúñiga Zamalloa, *Exploiting
Light To Enhance The Endurance and Navigation of Lighter-Than-Air Micro-Drones*, 2025) in this
system. This file is what it came to: generated, every figure of ours measured, none typed.

<!-- not run: minutes; test_paper.py runs the quick rows -->
```sh
./lta reproduce --list            # the rows
./lta reproduce --quick           # one seed, what is long left out: under three minutes
./lta reproduce                   # all seeds; goes on where it was stopped
./lta reproduce indoors energy    # some rows
./lta reproduce --markdown > docs/paper.md
```

The command writes a page too, with every picture, table and figure, and the bags of the flights
that are drawn, below its folder; what shows no flight (vehicle files, cells, light blocks,
bearings on a bench) has a command alone. A row is a file in `config/paper`: what the paper says
and where, what is measured, and the rule by which it agrees.
"""
IMAGES: Final = 'images/paper'


def page(rows: Sequence[PaperRow], kepts: Kepts) -> str:
    """Return the file."""
    parts = [
        HEAD,
        f'**{lines.title(rows, kepts)}** {lines.METHOD}\n',
        table(lines.SUMMARY_HEADS, lines.summary(rows, kepts)),
        *(row_part(row, kepts[row.name]) for row in rows),
        "## What the paper's figures let discovery say\n",
        f'{lines.DISCOVERY}\n',
        table(lines.SERIES_HEADS, lines.series(rows, kepts)),
        '## Where the paper does not add up\n',
        table(lines.DEFECT_HEADS, lines.defects(rows)),
        '## What rows change of the shared vehicle, gains, lamp and room\n',
        table(('row', 'what it changes'), lines.deviations(rows)),
    ]
    return '\n'.join(parts)


def row_part(row: PaperRow, kept: Kept) -> str:
    """Return the section of a row."""
    told = [
        f'- *{says}* {" ".join(filter(None, [finding, f"**{gap}**" if gap else ""]))}'
        for says, finding, gap in lines.notes(row, kept)
        if finding or gap
    ]
    commands = list(dict.fromkeys(each.command for each in kept.pictures if each.command))
    typed = '; '.join(f'`{each}`' for each in commands)
    bags = list(dict.fromkeys(each.bag for each in kept.pictures if each.bag))
    recorded = ', '.join(f'`{each}`' for each in bags)
    return '\n'.join([
        f'## {row.number}. {row.title}\n',
        f'{row.scenario}\n',
        table(lines.CLAIM_HEADS, lines.claims(row, kept)),
        *told,
        '',
        *image(row, kept),
        *([f'To see its pictures: {typed}.', ''] if typed else []),
        *([f'Its bags: {recorded}.', ''] if recorded else []),
    ])  # fmt: skip


def image(row: PaperRow, kept: Kept) -> list[str]:
    """Return the first picture of a row; `--pictures docs/images/paper` draws all of them."""
    if not kept.pictures:
        return []
    first = kept.pictures[0]
    return [
        f'![{first.heading}]({IMAGES}/{row.name}-{first.name}.png)\n',
        f'*{first.heading}. {first.caption}*\n',
    ]


def table(heads: Sequence[str], body: Lines) -> str:
    """Return a table of Markdown."""
    rows = [list(heads), ['---'] * len(heads), *body]
    return '\n'.join(f'| {" | ".join(cells)} |' for cells in rows) + '\n'
