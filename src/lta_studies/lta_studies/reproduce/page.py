"""Write the reproduction as one self-contained HTML page."""

from collections.abc import Mapping, Sequence
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_config.schema.paper_file import PaperRow
from lta_report.formatting import Tile
from lta_report.html_elements import embed_picture, render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_studies.energy.tables import render_text_table
from lta_studies.reproduce import lines
from lta_studies.reproduce.lines import Kepts, Lines
from lta_studies.reproduce.stored_row import StoredPicture, StoredRow
from lta_studies.reproduce.verdict import ClaimVerdict
from plotly.io import from_json

ABOUT: Final = (
    'Every experiment of the paper (Huang et al. 2025), repeated in this system: what the '
    'paper says, what we get, and why they differ.'
)
MARKS: Final = {
    ClaimVerdict.AGREES: 'agrees', ClaimVerdict.DIFFERS: 'differs',
    ClaimVerdict.UNTESTED: 'untested', ClaimVerdict.LEFT_OUT: 'left',
    ClaimVerdict.BEYOND: 'agrees',
}  # fmt: skip


def write_page(
    rows: Sequence[PaperRow], stored_rows: Kepts, commands: Mapping[str, str], out: Path
) -> Path:
    """Write the page and return its path; raise `BadInput` if that fails."""
    return write_file(render_page(rows, stored_rows, commands), out)


def render_page(rows: Sequence[PaperRow], stored_rows: Kepts, commands: Mapping[str, str]) -> str:
    """Return the HTML of the page."""
    return assemble_page(
        'reproduce.html',
        title=escape(lines.format_headline(rows, stored_rows)),
        kicker='the paper, reproduced',
        about=escape(ABOUT),
        tiles='\n'.join(render_tile(*each) for each in build_tiles(rows, stored_rows)),
        summary=render_table(
            'counts', lines.SUMMARY_HEADS, lines.build_summary_rows(rows, stored_rows)
        ),
        method=escape(lines.METHOD),
        rows='\n'.join(render_row(row, stored_rows[row.name]) for row in rows),
        discovery=escape(lines.DISCOVERY.replace('`', '')),
        series=render_table(
            'defects', lines.SERIES_HEADS, lines.build_paper_figure_rows(rows, stored_rows)
        ),
        defects=render_table('defects', lines.DEFECT_HEADS, lines.build_defect_rows(rows)),
        deviations=render_table(
            'deviations', ('row', 'deviation'), lines.build_deviation_rows(rows)
        ),
        facts={'rows': str(len(rows)), 'commit': read_commit()},
        commands=commands,
    )


def build_tiles(rows: Sequence[PaperRow], stored_rows: Kepts) -> list[Tile]:
    """Return a tile for each verdict, and one for the defects."""
    found = lines.count_all_verdicts(rows, stored_rows)
    # Results beyond the paper are not claims of the paper.
    total = sum(found.values()) - found[ClaimVerdict.BEYOND]
    made = [
        Tile(
            str(verdict),
            str(count),
            '',
            'future work of the paper' if verdict is ClaimVerdict.BEYOND else f'of {total} claims',
        )
        for verdict, count in found.items()
        if count
    ]
    count = sum(len(row.defects) for row in rows)
    return [*made, Tile('defects of the paper', str(count), '', 'with their arithmetic below')]


def render_row(row: PaperRow, stored: StoredRow) -> str:
    """Return the section of a row."""
    heading = f'{row.number}. {row.title}'
    pictures = ''.join(render_picture(row.name, each) for each in stored.pictures)
    return (
        f'<section class="panel row" id="{row.name}" aria-labelledby="title-{row.name}">'
        f'<h2 id="title-{row.name}">{escape(heading)}</h2>'
        f'<p class="note">{escape(row.scenario)}</p>'
        f'{render_table("claims", lines.CLAIM_HEADS, lines.build_claim_rows(row, stored))}'
        f'{render_findings(row, stored)}'
        f'<details><summary>All measurements ({len(stored.values)} figures, '
        # Rounded up, so that no row takes 0 s.
        f'{math.ceil(stored.seconds)} s)</summary>'
        f'{render_table("measures", lines.MEASURE_HEADS, lines.build_measure_rows(row, stored))}'
        f'{"".join(render_text_table(each) for each in stored.tables)}</details>'
        f'</section><div class="grid">{pictures}</div>'
    )


def render_findings(row: PaperRow, stored: StoredRow) -> str:
    """Return the list of findings, with what would close the gaps."""
    items = []
    for says, finding, gap in lines.list_claim_findings(row, stored):
        words = ' '.join(filter(None, [escape(finding), f'<b>{escape(gap)}</b>' if gap else '']))
        if words:
            items.append(f'<li><i>{escape(says)}</i> {words}</li>')
    return f'<ul class="said">{"".join(items)}</ul>' if items else ''


def render_picture(row: str, stored: StoredPicture) -> str:
    """Return a picture with its command and the bag of its flight."""
    name, words = f'{row}-{stored.name}', escape(stored.heading)
    body = embed_picture(name, words, escape(stored.caption), from_json(stored.figure), False)
    again = f'<p class="note again"><code>{escape(stored.command)}</code>'
    if stored.bag:
        again += f' · bag: <a href="{escape(stored.bag)}"><code>{escape(stored.bag)}</code></a>'
    return render_section(name, stored.heading, '', f'{body}{again}</p>')


def render_table(kind: str, heads: Sequence[str], body: Lines) -> str:
    """Return an HTML table; cells that hold a verdict get its class."""
    head = ''.join(f'<th scope="col">{escape(each)}</th>' for each in heads)
    rows = []
    for first, *rest in body:
        cells = ''.join(f'<td{format_verdict_class(cell)}>{escape(cell)}</td>' for cell in rest)
        rows.append(f'<tr><th scope="row">{escape(first)}</th>{cells}</tr>')
    return (
        f'<div class="wide"><table class="{kind}"><thead><tr>{head}</tr></thead>'
        f'<tbody>{"".join(rows)}</tbody></table></div>'
    )


def format_verdict_class(cell: str) -> str:
    """Return the class attribute of a verdict cell; '' for any other cell."""
    # `ClaimVerdict` is a StrEnum, so its members equal their words.
    found = next((name for verdict, name in MARKS.items() if cell == verdict), None)
    return f' class="{found}"' if found else ''
