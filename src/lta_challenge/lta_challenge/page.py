"""Write a challenge score as a self-contained HTML page."""

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_challenge.pictures import plot_confusion, plot_coverage, plot_strength
from lta_challenge.rows import ROWS
from lta_challenge.score import ChallengeScore
from lta_challenge.score_report import (
    format_error_and_time,
    format_median_errors,
    format_outcome_table,
    format_outside_kinds,
    format_score_figures,
    format_wrong_cases,
    OUTSIDE_HEADS,
)
from lta_challenge.score_statistics import compute_score_figures, LATE
from lta_config.command_line import format_lta_command
from lta_report.html_elements import render_section, render_tile
from lta_report.page_frame import assemble_page, write_file

NAME: Final = 'report.html'
# Figures shown as tiles, with their targets.
SHOWN: Final = {
    'one hidden effect, 6 sigma or more: named exactly': '97 %',
    'one hidden effect: a wrong one named': '2 % at most',
    'no hidden effect: an effect named': '1 % at most',
    'effect outside the library: unexplained force reported': '90 %',
    f'effect outside the library{LATE}: unexplained force reported': '90 %',
    '95 % intervals that contain the true value': '90 to 98 %',
}


def write_page(scored: ChallengeScore, folder: Path) -> Path:
    """Write the page and return where it is; `BadInput` if it cannot be written."""
    return write_file(render_page(scored, folder), folder / NAME)


def render_page(scored: ChallengeScore, folder: Path) -> str:
    """Return the whole page."""
    about, cases = scored.about, scored.cases
    row = ROWS[about['row']]
    shares = {each.name: each.share for each in compute_score_figures(cases)}
    tiles = [
        (name, f'{shares[name].hits}/{shares[name].of}', '', f'target: {wanted}')
        for name, wanted in SHOWN.items()
    ]
    return assemble_page(
        'challenge.html',
        title=escape(f'Discovery results for {len(cases)} cases with hidden effects'),
        kicker=escape(f'challenge {about["seed"]} \N{MIDDLE DOT} {about["row"]}'),
        about=escape(
            f'Flights: {row.about}. {format_median_errors(cases)} {format_error_and_time(cases)}'
        ),
        tiles='\n'.join(render_tile(*each) for each in tiles),
        pictures=_render_plot_sections(scored),
        figures=_render_table(['figure', 'share', 'target', 'met'], format_score_figures(cases)),
        matrix=_render_table(*format_outcome_table(cases)),
        outside=_render_table(OUTSIDE_HEADS, format_outside_kinds(cases)),
        wrong=_render_table(['case', 'row', 'kind', 'hidden', 'named'], format_wrong_cases(cases)),
        facts={
            'challenge': str(folder), 'seed': str(about['seed']), 'cases': str(len(cases)),
            'row': about['row'], 'effects': about['registry'],
            'vehicle': f'{about["vehicle"]} {about["vehicle_digest"]}', 'commit': about['commit'],
        },
        commands={
            'make it again': format_lta_command(
                'challenge', 'make', '--seed', str(about['seed']), '--n', str(about['cases']),
                '--row', about['row'], '--out', 'DIR',
            ),
            'score it': format_lta_command('challenge', 'score', 'DIR'),
        },
    )  # fmt: skip


def _render_plot_sections(scored: ChallengeScore) -> str:
    """Return the plots as page sections."""
    cases = scored.cases
    shown = [
        render_section(
            'confusion',
            'Confusion of effects',
            'Number of cases by hidden effect (rows) and effect that discovery named (columns), '
            'for cases with at most one hidden effect. If several effects were named and one of '
            'them is wrong, the case counts as wrong.',
            plot_confusion(cases),
        ),
        render_section(
            'strength',
            'Detection by strength',
            'Share of cases with one hidden effect in which discovery named exactly this effect, '
            'a wrong one, or none (silent), by strength. Strength is the size of the effect '
            'divided by its standard deviation, given these flights and the tolerance of the '
            'vehicle. Bars are 95 % intervals (Wilson).',
            plot_strength(cases),
        ),
    ]
    if any(one.intervals for one in cases):
        caption = (
            'Each dot is a parameter of a correctly named effect: true value minus estimate, in '
            'half widths of the 95 % interval. 95 % of the dots should lie between the lines.'
        )
        shown.append(
            render_section('coverage', 'Coverage of the intervals', caption, plot_coverage(cases))
        )
    return '\n'.join(shown)


def _render_table(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return an HTML table, or the note "None." without rows."""
    if not lines:
        return '<p class="note">None.</p>'
    head = ''.join(f'<th scope="col">{escape(each)}</th>' for each in heads)
    body = ''.join(
        f'<tr>{"".join(f"<td>{escape(each)}</td>" for each in cells)}</tr>' for cells in lines
    )
    return f'<table class="results"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
