"""Write the evaluation as one self-contained HTML file."""

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_config.command_line import format_lta_command, relative_path
from lta_report.formatting import Tile
from lta_report.html_elements import render_html_table, render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_studies.light.evaluation import labels, pictures, pilot, tables, tracks
from lta_studies.light.evaluation.cells import EvaluationCell
from lta_studies.light.evaluation.findings import EvaluationFindings
from lta_studies.light.evaluation.sets import ABLATIONS, find_flight_set, INDOORS, WINDS
from plotly.graph_objects import Figure

NAME: Final = 'report.html'
METHOD: Final = (
    'Reached: share of the flights, with 95 % Wilson interval. Path, time and ratios: means '
    'over the flights that reached the lamp, with 95 % bootstrap intervals. Path: length '
    'over ground from take-off to the goal circle. Time: from the first forward command. '
    'The pilot is a reference that knows the lamp and the wind and flies as straight as '
    'vehicle, controller and mission allow. Ratios to it are over the seeds in which both '
    'arrived.'
)
DRAWN: Final = 'All strategies with the same seed, seen from above.'


def write_page(findings: EvaluationFindings) -> Path:
    """Write the page and return its path; raise `BadInput` if that fails."""
    return write_file(render_page(findings), findings.folder / NAME)


def render_page(findings: EvaluationFindings) -> str:
    """Return the HTML of the page."""
    return assemble_page(
        'evaluate.html',
        title=escape(findings.title),
        kicker=escape(
            f'light \N{MIDDLE DOT} evaluation \N{MIDDLE DOT} {findings.flight_count_text}'
        ),
        about=escape(findings.about),
        tiles='\n'.join(render_tile(*each) for each in build_tiles(findings)),
        first='\n'.join(render_indoor_sections(findings)),
        pictures='\n'.join(render_set_sections(findings)),
        order=render_order(findings),
        targets=render_table(
            tables.TARGET_HEADS, tables.build_target_rows(findings.cells, findings.own_strategy)
        ),
        paper=render_table(
            tables.PAPER_HEADS, tables.build_paper_rows(findings.cells.get(INDOORS, []))
        )
        + render_table(
            tables.OUTDOOR_HEADS, tables.build_wind_rows(findings.cells.get(WINDS, []))
        ),
        cautions=''.join(f'<p class="note">{escape(each)}</p>' for each in findings.cautions),
        results=render_set_tables(findings) + f'<p class="note">{escape(METHOD)}</p>',
        facts=build_provenance_table(findings),
        commands=suggest_commands(findings),
    )


def build_tiles(findings: EvaluationFindings) -> list[Tile]:
    """Return tiles of the strategies in the first set with flights."""
    name = next((each for each, own in findings.cells.items() if own), next(iter(findings.cells)))
    return [
        Tile(
            labels.label_strategy(cell.strategy), f'{100 * cell.reached_share.value:.0f}', '%',
            f'reached; path {labels.format_mean(cell.mean("path_length"))} m',
        )
        for cell in findings.cells[name]
        if cell.strategy != pilot.NAME and cell.rows and cell.case == findings.cells[name][0].case
    ]  # fmt: skip


def render_indoor_sections(findings: EvaluationFindings) -> list[str]:
    """Return the sections of the indoor set: comparison with the paper, and tracks."""
    cells = [cell for cell in findings.cells.get(INDOORS, []) if cell.rows]
    if not cells:
        return []
    part = find_flight_set(INDOORS)
    # One seed for all tracks, so that start and noise are the same.
    seed = tracks.select_track_seed(cells)
    flown, scenario = tracks.fly_again(findings.plans[INDOORS], cells, seed)
    height = findings.plans[INDOORS].base.read_value('mission.altitude')
    return [
        render_section('indoors', part.title, part.about, pictures.plot_paper_comparison(cells)),
        render_section('tracks', 'One flight of each strategy', f'{DRAWN} Seed {seed}.',
                tracks.plot_tracks(flown, scenario, height)),
    ]  # fmt: skip


def render_set_sections(findings: EvaluationFindings) -> list[str]:
    """Return a section for each other set."""
    made = []
    for name, cells in findings.cells.items():
        part, own = find_flight_set(name), [cell for cell in cells if cell.rows]
        if name != INDOORS and own:
            made.append(render_section(name, part.title, part.about, plot_set(name, own)))
    return made


def plot_set(name: str, cells: Sequence[EvaluationCell]) -> Figure:
    """Return the plot of a set."""
    axis = find_flight_set(name).axis
    return pictures.plot_factors(cells) if axis is None else pictures.plot_along_axis(cells, axis)


def render_order(findings: EvaluationFindings) -> str:
    """Return the statement on the paper's order of paths, with its table."""
    body = tables.build_path_order_rows(findings.ablations)
    shown = render_table(tables.ORDER_HEADS, body) if body else ''
    return f'<p class="statement">{escape(findings.statement)}</p>{shown}'


def render_set_tables(findings: EvaluationFindings) -> str:
    """Return a table for each set."""
    return ''.join(
        f'<h3>{escape(find_flight_set(name).title)}</h3>'
        + render_table(tables.HEADS, tables.build_set_rows(name, cells))
        for name, cells in findings.cells.items()
    )


def render_table(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return an HTML table, or a note if it is empty."""
    if not lines:
        return '<p class="note">Not flown.</p>'
    return f'<div class="wide">{render_html_table(heads, lines)}</div>'


def build_provenance_table(findings: EvaluationFindings) -> dict[str, str]:
    """Return the provenance table of the page."""
    return {
        'sets': ', '.join(findings.cells),
        'sweeps': ', '.join(find_flight_set(name).file for name in findings.cells),
        'seeds': f'1 to {findings.seeds}',
        'flights': findings.flight_count_text,
        'work': f'{findings.computing_time:.0f} s of processor time',
        'commit': read_commit(),
    }


def suggest_commands(findings: EvaluationFindings) -> dict[str, str]:
    """Return commands for the next steps."""
    names = [word for name in findings.cells for word in ('--sets', name)]
    names = [] if set(findings.cells) == set(findings.all_sets) else names
    return {
        'Resume or repeat': format_lta_command(
            'light', 'evaluate', '--seeds', str(findings.seeds), *names,
            '--out', relative_path(findings.folder),
        ),
        'Fly only one set': format_lta_command(
            'sweep', find_flight_set(next(iter(findings.cells))).file,
        ),
        **(
            {} if ABLATIONS not in findings.cells
            else {
                'Fly only the ablations': format_lta_command(
                    'sweep', find_flight_set(ABLATIONS).file,
                ),
            }
        ),
    }  # fmt: skip
