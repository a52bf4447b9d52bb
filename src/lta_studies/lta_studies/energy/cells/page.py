"""Cells and arrays as one self-contained page."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_config.schema.cell_table import CellTable
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_report.drawing import create_figure
from lta_report.formatting import format_number, Tile
from lta_report.page_frame import assemble_page, write_file
from lta_report.page_parts import render_section, render_tile
from lta_report.palette import ESTIMATE, SOFT, TRUTH
from lta_studies.energy.cells.arrays import build_all_arrays, compute_net_powers
from lta_studies.energy.cells.ranking import CellEntry, Figure, list_entries
from lta_studies.energy.cells.tables import (
    build_array_table,
    build_mass_budget_table,
    build_ranking_table,
    find_both_fronts,
    GRAMS,
    SQUARE,
    WORDS,
)
from lta_studies.energy.tables import render_text_table
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
    table: CellTable, energy: EnergyBlock, budget: float, commands: Mapping[str, str], out: Path
) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return write_file(render_page(table, energy, budget, commands), out)


def render_page(
    table: CellTable, energy: EnergyBlock, budget: float, commands: Mapping[str, str]
) -> str:
    """Return the whole page; the budget is a mass. [kg]"""
    found = list_entries(table)
    fronts = [find_both_fronts(found, which) for which in range(max(e.readings for e in found))]
    paper, fair = zip(*fronts, strict=True)
    by_area = draw_fronts(found, lambda each: each.charging_time_per_area / SQUARE, 's/cm²', paper)
    times_area = draw_fronts(
        found, lambda each: each.charging_time_times_area * SQUARE, 's cm²', fair
    )
    return assemble_page(
        'energy.html',
        title=escape(TITLE),
        kicker=escape(f'cells · {table.name}'),
        about=escape(table.about),
        tiles='\n'.join(render_tile(*each) for each in build_tiles(table, energy)),
        first=render_section('paper', 'As the paper counts', PAPER, by_area),
        pictures=render_section('fair', 'As is fair', FAIR, times_area),
        tables=''.join(
            render_text_table(each)
            for each in (
                build_ranking_table(table),
                build_array_table(table, energy),
                build_mass_budget_table(table, energy, budget),
            )
        ),
        method=''.join(f'<p class="note">{escape(each)}</p>' for each in METHOD),
        facts={'table': table.name, 'commit': read_commit()},
        commands=commands,
    )


def build_tiles(table: CellTable, energy: EnergyBlock) -> list[Tile]:
    """Return the net power of the paper's arrays in stand-by, each reading in each light."""
    made = []
    for name, strings in build_all_arrays(table).items():
        for strung in strings:
            for net in compute_net_powers(strung, energy, table):
                size = f'{SQUARE * strung.area:.0f} cm² of {name}'
                light = WORDS.get(net.light, net.light)
                made.append(
                    Tile(size, format_number(net.standby, 1, 1e3), 'mW', f'stand-by, {light}')
                )
    return made


def draw_fronts(
    entries: Sequence[CellEntry], figure: Figure, unit: str, fronts: Sequence[Sequence[CellEntry]]
) -> Picture:
    """Return cells in the plane of mass by area and a figure, with their fronts."""
    drawn = create_figure()
    for kept, dash in zip(fronts, ('solid', '5px,4px'), strict=False):
        drawn.add_trace(
            Scatter(
                x=[_areal_mass(each) for each in kept], y=[figure(each) for each in kept],
                mode='lines', line={'color': TRUTH, 'width': 1.6, 'dash': dash},
                hoverinfo='skip',
            )
        )  # fmt: skip
    on = {id(each) for kept in fronts for each in kept}
    drawn.add_trace(
        Scatter(
            x=[_areal_mass(each) for each in entries], y=[figure(each) for each in entries],
            mode='markers+text', text=[each.title for each in entries],
            textposition=[SIDES.get(each.row.maker, 'top center') for each in entries],
            textfont={'color': SOFT, 'size': 11},
            marker={
                'size': 9, 'color': [ESTIMATE if id(each) in on else SOFT for each in entries],
            },
            hovertemplate=f'%{{text}}: %{{x:.3f}} g/cm², %{{y:.3g}} {unit}<extra></extra>',
        )
    )  # fmt: skip
    drawn.update_layout(hovermode='closest')
    drawn.update_xaxes(
        type='log', title_text='mass by area [g/cm²]', range=[-1.6, -0.05], dtick='D2'
    )
    return drawn.update_yaxes(type='log', title_text=f'charging time [{unit}]', dtick='D2')


def _areal_mass(each: CellEntry) -> float:
    return each.areal_mass * GRAMS / SQUARE
