"""The evaluation as one self-contained HTML file, in the look of a flight's page."""

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import commit
from lta_config.typed import near, typed
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.pieces import section, table_html, tile_html
from lta_studies.light.evaluation import pictures, pilot, tables, tracks, words
from lta_studies.light.evaluation.cells import Cell
from lta_studies.light.evaluation.findings import Findings
from lta_studies.light.evaluation.sets import ABLATIONS, flight_set, INDOORS, WINDS
from plotly.graph_objects import Figure

NAME: Final = 'report.html'
METHOD: Final = (
    'Reached: with the 95 % interval of Wilson. Path, time and ratios: means over the flights '
    'that reached the lamp, with 95 % intervals by the bootstrap. Path: over ground, from the '
    'take-off to the goal circle. Time: from the first forward command. The pilot knows lamp and '
    'wind and flies as straight as the same vehicle, controller and mission let it; ratios are '
    'taken over the seeds with which both arrived.'
)
DRAWN: Final = 'Every strategy with the same seed, seen from above.'


def write_page(found: Findings) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(found), found.folder / NAME)


def page(found: Findings) -> str:
    """Return the whole page."""
    return framed(
        'evaluate.html',
        title=escape(found.title),
        kicker=escape(f'light \N{MIDDLE DOT} evaluation \N{MIDDLE DOT} {found.count}'),
        about=escape(found.about),
        tiles='\n'.join(tile_html(*each) for each in tiles(found)),
        first='\n'.join(indoors(found)),
        pictures='\n'.join(sections(found)),
        order=order_html(found),
        targets=table(tables.TARGET_HEADS, tables.targets(found.cells, found.ours)),
        paper=table(tables.PAPER_HEADS, tables.beside_paper(found.cells.get(INDOORS, [])))
        + table(tables.OUTDOOR_HEADS, tables.outdoors(found.cells.get(WINDS, []))),
        cautions=''.join(f'<p class="note">{escape(each)}</p>' for each in found.cautions),
        results=results(found) + f'<p class="note">{escape(METHOD)}</p>',
        facts=facts(found),
        commands=commands(found),
    )


def tiles(found: Findings) -> list[Tile]:
    """Return how each strategy does indoors, or in the first set there is."""
    name = next((each for each, own in found.cells.items() if own), next(iter(found.cells)))
    return [
        Tile(
            words.strategy(cell.strategy), f'{100 * cell.reached.value:.0f}', '%',
            f'reached; path {words.amount(cell.mean("path_length"))} m',
        )
        for cell in found.cells[name]
        if cell.strategy != pilot.NAME and cell.rows and cell.case == found.cells[name][0].case
    ]  # fmt: skip


def indoors(found: Findings) -> list[str]:
    """Return the paper's flight: the figures of all strategies, and a flight of each."""
    cells = [cell for cell in found.cells.get(INDOORS, []) if cell.rows]
    if not cells:
        return []
    part = flight_set(INDOORS)
    seed = tracks.shown_seed(cells)
    flown, scenario = tracks.fly_again(found.plans[INDOORS], cells, seed)
    height = found.plans[INDOORS].base.held('mission.altitude')
    return [
        section('indoors', part.title, part.about, pictures.beside_paper(cells)),
        section('tracks', 'A flight of each', f'{DRAWN} Seed {seed}.',
                tracks.picture(flown, scenario, height)),
    ]  # fmt: skip


def sections(found: Findings) -> list[str]:
    """Return a picture for each further set."""
    made = []
    for name, cells in found.cells.items():
        part, own = flight_set(name), [cell for cell in cells if cell.rows]
        if name != INDOORS and own:
            made.append(section(name, part.title, part.about, picture(name, own)))
    return made


def picture(name: str, cells: Sequence[Cell]) -> Figure:
    """Return the picture of a set."""
    axis = flight_set(name).axis
    return pictures.factors(cells) if axis is None else pictures.along(cells, axis)


def order_html(found: Findings) -> str:
    """Return what makes the paper's order of paths, in words and as a table."""
    body = tables.order_lines(found.ablations)
    shown = table(tables.ORDER_HEADS, body) if body else ''
    return f'<p class="statement">{escape(found.statement)}</p>{shown}'


def results(found: Findings) -> str:
    """Return a table for each set."""
    return ''.join(
        f'<h3>{escape(flight_set(name).title)}</h3>'
        + table(tables.HEADS, tables.lines(name, cells))
        for name, cells in found.cells.items()
    )


def table(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a table, or that there is nothing in it."""
    if not lines:
        return '<p class="note">Not flown.</p>'
    return f'<div class="wide">{table_html(heads, lines)}</div>'


def facts(found: Findings) -> dict[str, str]:
    """Return where the figures come from."""
    return {
        'sets': ', '.join(found.cells),
        'sweeps': ', '.join(flight_set(name).file for name in found.cells),
        'seeds': f'1 to {found.seeds}',
        'flights': found.count,
        'work': f'{found.work:.0f} s of one processor',
        'commit': commit(),
    }


def commands(found: Findings) -> dict[str, str]:
    """Return how to go on."""
    names = [word for name in found.cells for word in ('--sets', name)]
    names = [] if set(found.cells) == set(found.all_sets) else names
    return {
        'Go on, or do it again': typed(
            'light', 'evaluate', '--seeds', str(found.seeds), *names, '--out', near(found.folder)
        ),
        'Fly one set alone': typed('sweep', flight_set(next(iter(found.cells))).file),
        **(
            {} if ABLATIONS not in found.cells
            else {'Fly the ablations alone': typed('sweep', flight_set(ABLATIONS).file)}
        ),
    }  # fmt: skip
