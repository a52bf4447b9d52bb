"""A score as one self-contained HTML file, in the look of a flight's page."""

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_challenge.pictures import confusion, coverage, strength
from lta_challenge.rows import ROWS
from lta_challenge.score import Scored
from lta_challenge.tally import figures, LATE
from lta_challenge.told import (
    cost_line,
    figure_lines,
    ladder_line,
    matrix_lines,
    OUTSIDE_HEADS,
    outside_lines,
    wrong_lines,
)
from lta_config.typed import typed
from lta_report.frame import framed, written
from lta_report.pieces import section, tile_html

NAME: Final = 'report.html'
# Of the figures, large, and what they are to be.
SHOWN: Final = {
    'one effect, 6 sigma or more: exact': '97 %',
    'one effect: a wrong name': '2 % at most',
    'nothing hidden: any name': '1 % at most',
    'outside the library: unexplained': '90 %',
    f'outside the library{LATE}: unexplained': '90 %',
    'intervals of 95 % that hold the truth': '90 to 98 %',
}


def write_page(scored: Scored, folder: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(scored, folder), folder / NAME)


def page(scored: Scored, folder: Path) -> str:
    """Return the whole page."""
    about, cases = scored.about, scored.cases
    row = ROWS[about['row']]
    shares = {each.name: each.share for each in figures(cases)}
    tiles = [
        (name, f'{shares[name].hits}/{shares[name].of}', '', f'wanted: {wanted}')
        for name, wanted in SHOWN.items()
    ]
    return framed(
        'challenge.html',
        title=escape(f'{len(cases)} hidden cases: who was found, and who was taken for whom'),
        kicker=escape(f'challenge {about["seed"]} \N{MIDDLE DOT} {about["row"]}'),
        about=escape(f'{row.about}. {ladder_line(cases)} {cost_line(cases)}'),
        tiles='\n'.join(tile_html(*each) for each in tiles),
        pictures=_pictures(scored),
        figures=_table(['figure', 'share', 'wanted', 'met'], figure_lines(cases)),
        matrix=_table(*matrix_lines(cases)),
        outside=_table(OUTSIDE_HEADS, outside_lines(cases)),
        wrong=_table(['case', 'row', 'kind', 'hidden', 'named'], wrong_lines(cases)),
        facts={
            'challenge': str(folder), 'seed': str(about['seed']), 'cases': str(len(cases)),
            'row': about['row'], 'effects': about['registry'],
            'vehicle': f'{about["vehicle"]} {about["vehicle_digest"]}', 'commit': about['commit'],
        },
        commands={
            'make it again': typed(
                'challenge', 'make', '--seed', str(about['seed']), '--n', str(about['cases']),
                '--row', about['row'], '--out', 'DIR',
            ),
            'score it': typed('challenge', 'score', 'DIR'),
        },
    )  # fmt: skip


def _pictures(scored: Scored) -> str:
    """Return the pictures."""
    cases = scored.cases
    shown = [
        section(
            'confusion',
            'Who is taken for whom',
            'Cases with one thing hidden at most; a wrong name counts before a right one.',
            confusion(cases),
        ),
        section(
            'strength',
            'From what strength on',
            'Single effects by how many deviations they come to in these flights, the tolerance '
            'of the vehicle among them; bars are 95 % intervals (Wilson).',
            strength(cases),
        ),
    ]
    if any(one.intervals for one in cases):
        caption = 'Each parameter that was rightly named; 95 % should lie between the lines.'
        shown.append(section('coverage', 'How sure it may be', caption, coverage(cases)))
    return '\n'.join(shown)


def _table(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a table, or that there is nothing in it."""
    if not lines:
        return '<p class="note">None.</p>'
    head = ''.join(f'<th scope="col">{escape(each)}</th>' for each in heads)
    body = ''.join(
        f'<tr>{"".join(f"<td>{escape(each)}</td>" for each in cells)}</tr>' for cells in lines
    )
    return f'<table class="results"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
