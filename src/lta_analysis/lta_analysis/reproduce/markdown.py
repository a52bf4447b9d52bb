"""The reproduction as docs/paper.md."""

from collections.abc import Sequence
from typing import Final

from lta_analysis.reproduce import lines
from lta_analysis.reproduce.kept import Kept
from lta_analysis.reproduce.lines import Kepts, Lines
from lta_config.paper_file import PaperRow

HEAD: Final = """# The paper, reproduced

`./lta reproduce` runs every experiment of the seed paper in this system and writes a page with
its pictures. This file is what it came to: generated, every figure of ours measured.

```sh
./lta reproduce --list            # the rows
./lta reproduce --quick           # one seed, under three minutes
./lta reproduce                   # all seeds; goes on where it was stopped
./lta reproduce --markdown > docs/paper.md
```
"""


def page(rows: Sequence[PaperRow], kepts: Kepts) -> str:
    """Return the file."""
    parts = [
        HEAD,
        f'**{lines.title(rows, kepts)}** {lines.METHOD}\n',
        table(lines.SUMMARY_HEADS, lines.summary(rows, kepts)),
        *(row_part(row, kepts[row.name]) for row in rows),
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
    return '\n'.join([
        f'## {row.number}. {row.title}\n',
        f'{row.scenario}\n',
        table(lines.CLAIM_HEADS, lines.claims(row, kept)),
        *told,
        *(['', f'Its pictures: {typed}.'] if typed else []),
        '',
    ])  # fmt: skip


def table(heads: Sequence[str], body: Lines) -> str:
    """Return a table of Markdown."""
    rows = [list(heads), ['---'] * len(heads), *body]
    return '\n'.join(f'| {" | ".join(cells)} |' for cells in rows) + '\n'
