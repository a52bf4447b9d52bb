"""The reproduction as one self-contained page."""

from collections.abc import Mapping, Sequence
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_bridge.provenance import commit
from lta_config.schema.paper_file import PaperRow
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.pieces import drawn, section, tile_html
from lta_studies.energy.tables import table_html
from lta_studies.reproduce import lines
from lta_studies.reproduce.kept import Drawn, Kept
from lta_studies.reproduce.lines import Kepts, Lines
from lta_studies.reproduce.verdict import Verdict
from plotly.io import from_json

ABOUT: Final = (
    'Every experiment of the seed paper in this system: what it says, what we get, and why not '
    'where it differs.'
)
MARKS: Final = {
    Verdict.AGREES: 'agrees', Verdict.DIFFERS: 'differs', Verdict.UNTESTED: 'untested',
    Verdict.LEFT_OUT: 'left', Verdict.BEYOND: 'agrees',
}  # fmt: skip


def write_page(
    rows: Sequence[PaperRow], kepts: Kepts, commands: Mapping[str, str], out: Path
) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(rows, kepts, commands), out)


def page(rows: Sequence[PaperRow], kepts: Kepts, commands: Mapping[str, str]) -> str:
    """Return the whole page."""
    return framed(
        'reproduce.html',
        title=escape(lines.title(rows, kepts)),
        kicker='the paper, reproduced',
        about=escape(ABOUT),
        tiles='\n'.join(tile_html(*each) for each in tiles(rows, kepts)),
        summary=table('counts', lines.SUMMARY_HEADS, lines.summary(rows, kepts)),
        method=escape(lines.METHOD),
        rows='\n'.join(row_html(row, kepts[row.name]) for row in rows),
        discovery=escape(lines.DISCOVERY.replace('`', '')),
        series=table('defects', lines.SERIES_HEADS, lines.series(rows, kepts)),
        defects=table('defects', lines.DEFECT_HEADS, lines.defects(rows)),
        deviations=table('deviations', ('row', 'what it changes'), lines.deviations(rows)),
        facts={'rows': str(len(rows)), 'commit': commit()},
        commands=commands,
    )


def tiles(rows: Sequence[PaperRow], kepts: Kepts) -> list[Tile]:
    """Return the counts."""
    found = lines.totals(rows, kepts)
    total = sum(found.values()) - found[Verdict.BEYOND]
    made = [
        Tile(
            str(verdict),
            str(count),
            '',
            'its future work' if verdict is Verdict.BEYOND else f'of {total} claims',
        )
        for verdict, count in found.items()
        if count
    ]
    count = sum(len(row.defects) for row in rows)
    return [*made, Tile('defects of the paper', str(count), '', 'with their arithmetic, below')]


def row_html(row: PaperRow, kept: Kept) -> str:
    """Return the section of a row."""
    heading = f'{row.number}. {row.title}'
    pictures = ''.join(picture(row.name, each) for each in kept.pictures)
    return (
        f'<section class="panel row" id="{row.name}" aria-labelledby="title-{row.name}">'
        f'<h2 id="title-{row.name}">{escape(heading)}</h2>'
        f'<p class="note">{escape(row.scenario)}</p>'
        f'{table("claims", lines.CLAIM_HEADS, lines.claims(row, kept))}'
        f'{said(row, kept)}'
        f'<details><summary>All that was measured ({len(kept.values)} figures, '
        f'{math.ceil(kept.seconds)} s)</summary>'
        f'{table("measures", lines.MEASURE_HEADS, lines.measures(row, kept))}'
        f'{"".join(table_html(each) for each in kept.tables)}</details>'
        f'</section><div class="grid">{pictures}</div>'
    )


def said(row: PaperRow, kept: Kept) -> str:
    """Return findings, and what would close the gaps."""
    items = []
    for says, finding, gap in lines.notes(row, kept):
        words = ' '.join(filter(None, [escape(finding), f'<b>{escape(gap)}</b>' if gap else '']))
        if words:
            items.append(f'<li><i>{escape(says)}</i> {words}</li>')
    return f'<ul class="said">{"".join(items)}</ul>' if items else ''


def picture(row: str, kept: Drawn) -> str:
    """Return a picture with what to type for it, and the bag of its flight."""
    name, words = f'{row}-{kept.name}', escape(kept.heading)
    body = drawn(name, words, escape(kept.caption), from_json(kept.figure), False)
    again = f'<p class="note again"><code>{escape(kept.command)}</code>'
    if kept.bag:
        again += f' · its bag: <a href="{escape(kept.bag)}"><code>{escape(kept.bag)}</code></a>'
    return section(name, kept.heading, '', f'{body}{again}</p>')


def table(kind: str, heads: Sequence[str], body: Lines) -> str:
    """Return a table of lines; the last cell of a claim is marked by its verdict."""
    head = ''.join(f'<th scope="col">{escape(each)}</th>' for each in heads)
    rows = []
    for first, *rest in body:
        cells = ''.join(f'<td{mark(cell)}>{escape(cell)}</td>' for cell in rest)
        rows.append(f'<tr><th scope="row">{escape(first)}</th>{cells}</tr>')
    return (
        f'<div class="wide"><table class="{kind}"><thead><tr>{head}</tr></thead>'
        f'<tbody>{"".join(rows)}</tbody></table></div>'
    )


def mark(cell: str) -> str:
    """Return the class of a cell that is a verdict."""
    found = next((name for verdict, name in MARKS.items() if cell == verdict), None)
    return f' class="{found}"' if found else ''
