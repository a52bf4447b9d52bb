"""Write the reproduction as docs/paper.md."""

from collections.abc import Sequence
from typing import Final

from lta_config.schema.paper_file import PaperRow
from lta_studies.reproduce import lines
from lta_studies.reproduce.lines import Kepts, Lines
from lta_studies.reproduce.stored_row import StoredRow

HEAD: Final = """# The paper, reproduced

`./lta reproduce` runs every experiment of the paper (Huang, Xu and Zúñiga Zamalloa, *Exploiting
Light To Enhance The Endurance and Navigation of Lighter-Than-Air Micro-Drones*, 2025) in this
system. This file is generated from the results; none of our figures is typed by hand.

<!-- not run: minutes; test_paper.py runs the quick rows -->
```sh
./lta reproduce --list            # the rows
./lta reproduce --quick           # one seed, without the long parts: under three minutes
./lta reproduce                   # all seeds; resumes where it was stopped
./lta reproduce indoors energy    # some rows
./lta reproduce --markdown > docs/paper.md
```

The command also writes a page with every picture, table and figure, and records the plotted
flights as bags in its folder. Pictures that show no flight (vehicle files, cells, light blocks,
bearings on a bench) only have a command. A row is a file in `config/paper`: what the paper says
and where, what is measured, and the rule for agreement.
"""
IMAGES: Final = 'images/paper'


def format_markdown_page(rows: Sequence[PaperRow], stored_rows: Kepts) -> str:
    """Return the text of the file."""
    parts = [
        HEAD,
        f'**{lines.format_headline(rows, stored_rows)}** {lines.METHOD}\n',
        format_markdown_table(lines.SUMMARY_HEADS, lines.build_summary_rows(rows, stored_rows)),
        *(format_row_section(row, stored_rows[row.name]) for row in rows),
        "## What discovery concludes from the paper's figures\n",
        f'{lines.DISCOVERY}\n',
        format_markdown_table(
            lines.SERIES_HEADS, lines.build_paper_figure_rows(rows, stored_rows)
        ),
        '## Inconsistencies in the paper\n',
        format_markdown_table(lines.DEFECT_HEADS, lines.build_defect_rows(rows)),
        '## Deviations from the shared vehicle, gains, lamp and room\n',
        format_markdown_table(('row', 'deviation'), lines.build_deviation_rows(rows)),
    ]
    return '\n'.join(parts)


def format_row_section(row: PaperRow, stored: StoredRow) -> str:
    """Return the section of a row."""
    findings = [
        f'- *{says}* {" ".join(filter(None, [finding, f"**{gap}**" if gap else ""]))}'
        for says, finding, gap in lines.list_claim_findings(row, stored)
        # Claims that simply agree need no note.
        if finding or gap
    ]
    # Several pictures share a command: each once, in order.
    commands = list(dict.fromkeys(each.command for each in stored.pictures if each.command))
    typed = '; '.join(f'`{each}`' for each in commands)
    bags = list(dict.fromkeys(each.bag for each in stored.pictures if each.bag))
    recorded = ', '.join(f'`{each}`' for each in bags)
    return '\n'.join([
        f'## {row.number}. {row.title}\n',
        f'{row.scenario}\n',
        format_markdown_table(lines.CLAIM_HEADS, lines.build_claim_rows(row, stored)),
        *findings,
        '',
        *format_image(row, stored),
        *([f'Commands for its pictures: {typed}.', ''] if typed else []),
        *([f'Bags: {recorded}.', ''] if recorded else []),
    ])  # fmt: skip


def format_image(row: PaperRow, stored: StoredRow) -> list[str]:
    """Return the first picture of a row, as drawn by `--pictures docs/images/paper`."""
    if not stored.pictures:
        return []
    first = stored.pictures[0]
    return [
        f'![{first.heading}]({IMAGES}/{row.name}-{first.name}.png)\n',
        f'*{first.heading}. {first.caption}*\n',
    ]


def format_markdown_table(heads: Sequence[str], body: Lines) -> str:
    """Return a Markdown table."""
    rows = [list(heads), ['---'] * len(heads), *body]
    return '\n'.join(f'| {" | ".join(cells)} |' for cells in rows) + '\n'
