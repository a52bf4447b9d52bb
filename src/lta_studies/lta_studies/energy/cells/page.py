"""Cells and arrays as one self-contained page."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import commit
from lta_config.schema.cell_table import CellTable
from lta_config.schema.vehicle_energy import Energy
from lta_report.drawing import blank
from lta_report.formatting import number, Tile
from lta_report.frame import framed, written
from lta_report.palette import ESTIMATE, SOFT, TRUTH
from lta_report.pieces import section, tile_html
from lta_studies.energy.cells.ranked import entries, Entry, Figure
from lta_studies.energy.cells.rows import (
    afforded,
    both_fronts,
    GRAMS,
    ranking,
    SQUARE,
    trial,
    WORDS,
)
from lta_studies.energy.cells.strung import all_built, nets
from lta_studies.energy.tables import table_html
from plotly.graph_objects import Figure as Picture
from plotly.graph_objects import Scatter

TITLE: Final = 'Which solar cells are light and quick depends on how one counts.'
PAPER: Final = (
    'Charging time by area against mass by area, the figure of the seed paper. Dots: cells; lines '
    'those that no other beats in both, PowerFilm read as the small panel (full) or the large one '
    '(dashed). It rewards a large cell twice, for its time and its area.'
)
FAIR: Final = (
    'Charging time times area, which is the same for any size of the same cells, against mass by '
    'area. Full line: PowerFilm read as the 53.9 cm² that it names; dashed: as the 266.3 cm² '
    'whose size is printed. The reading decides whether Dracula is on the front.'
)
# Neighbours whose names would lie on each other.
SIDES: Final = {
    'Dracula': 'middle right', 'Kitronik': 'middle right', 'SEEED': 'top right',
    'ANYSOLAR': 'bottom center', 'PowerFilm': 'top right',
}  # fmt: skip
METHOD: Final = (
    'Areas are computed from the printed dimensions, read in cm where mm cannot be; masses are '
    'printed. Neither light nor capacitance of the charging test is printed: only ratios count.',
    'Harvest is that of the single-diode model behind each data sheet at the temperature that the '
    'light gives the cells; the charger tracks, converts and draws as the vehicle file says. Of '
    'the data sheets most numbers are assumed: each cell file says which.',
)


def write_page(
    table: CellTable, energy: Energy, budget: float, commands: Mapping[str, str], out: Path
) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(table, energy, budget, commands), out)


def page(table: CellTable, energy: Energy, budget: float, commands: Mapping[str, str]) -> str:
    """Return the whole page; the budget is a mass. [kg]"""
    found = entries(table)
    fronts = [both_fronts(found, which) for which in range(max(e.readings for e in found))]
    paper, fair = zip(*fronts, strict=True)
    by_area = picture(found, lambda each: each.by_area / SQUARE, 's/cm²', paper)
    times_area = picture(found, lambda each: each.times_area * SQUARE, 's cm²', fair)
    return framed(
        'energy.html',
        title=escape(TITLE),
        kicker=escape(f'cells · {table.name}'),
        about=escape(table.about),
        tiles='\n'.join(tile_html(*each) for each in tiles(table, energy)),
        first=section('paper', 'As the paper counts', PAPER, by_area),
        pictures=section('fair', 'As is fair', FAIR, times_area),
        tables=''.join(
            table_html(each)
            for each in (ranking(table), trial(table, energy), afforded(table, energy, budget))
        ),
        method=''.join(f'<p class="note">{escape(each)}</p>' for each in METHOD),
        facts={'table': table.name, 'commit': commit()},
        commands=commands,
    )


def tiles(table: CellTable, energy: Energy) -> list[Tile]:
    """Return the net power of the paper's arrays in stand-by, each reading in each light."""
    made = []
    for name, strings in all_built(table).items():
        for strung in strings:
            for net in nets(strung, energy, table):
                size = f'{SQUARE * strung.area:.0f} cm² of {name}'
                light = WORDS.get(net.light, net.light)
                made.append(Tile(size, number(net.standby, 1, 1e3), 'mW', f'stand-by, {light}'))
    return made


def picture(
    found: Sequence[Entry], figure: Figure, unit: str, fronts: Sequence[Sequence[Entry]]
) -> Picture:
    """Return cells in the plane of mass by area and a figure, with their fronts."""
    drawn = blank()
    for kept, dash in zip(fronts, ('solid', '5px,4px'), strict=False):
        drawn.add_trace(
            Scatter(
                x=[_areal(each) for each in kept], y=[figure(each) for each in kept],
                mode='lines', line={'color': TRUTH, 'width': 1.6, 'dash': dash},
                hoverinfo='skip',
            )
        )  # fmt: skip
    on = {id(each) for kept in fronts for each in kept}
    drawn.add_trace(
        Scatter(
            x=[_areal(each) for each in found], y=[figure(each) for each in found],
            mode='markers+text', text=[each.title for each in found],
            textposition=[SIDES.get(each.row.maker, 'top center') for each in found],
            textfont={'color': SOFT, 'size': 11},
            marker={'size': 9, 'color': [ESTIMATE if id(each) in on else SOFT for each in found]},
            hovertemplate=f'%{{text}}: %{{x:.3f}} g/cm², %{{y:.3g}} {unit}<extra></extra>',
        )
    )  # fmt: skip
    drawn.update_layout(hovermode='closest')
    drawn.update_xaxes(
        type='log', title_text='mass by area [g/cm²]', range=[-1.6, -0.05], dtick='D2'
    )
    return drawn.update_yaxes(type='log', title_text=f'charging time [{unit}]', dtick='D2')


def _areal(each: Entry) -> float:
    return each.areal_mass * GRAMS / SQUARE
