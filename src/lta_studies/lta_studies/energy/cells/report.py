"""Build the report of a comparison of solar cells and arrays."""

from collections.abc import Sequence
from typing import Final

from lta_config.schema.cell_file import CellTable
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_report.drawing import add_legend, create_figure
from lta_report.formatting import format_number, Tile
from lta_report.palette import ESTIMATE, SOFT, TRUTH
from lta_report.report import Picture, Report, TextSection
from lta_studies.energy.cells.arrays import build_all_arrays, compute_net_powers
from lta_studies.energy.cells.ranking import CellReading, Criterion, list_readings
from lta_studies.energy.cells.tables import (
    build_array_table,
    build_mass_budget_table,
    build_ranking_table,
    GRAMS,
    list_front_pairs,
    SQUARE,
    to_json,
    WORDS,
)
from plotly.graph_objects import Figure, Scatter

PAPER: Final = (
    'Charging time per area against mass per area, the criterion of the paper (Huang et al. '
    '2025). The paper does not say which size of PowerFilm panel it measured: the full line '
    'is the front with the small panel, the dashed line with the large one. The criterion '
    'favours large cells twice: they charge faster, and the time is divided by a larger area.'
)
FAIR: Final = (
    'Charging time times area, which does not depend on the size of a panel, against mass '
    'per area. Full line: PowerFilm read as the panel of 53.9 cm² that is named; dashed: as '
    'the size of 266.3 cm² that is printed. This choice decides whether the cell Dracula is '
    'on the Pareto front.'
)
# Label positions that keep the names of neighbours apart.
SIDES: Final = {
    'Dracula': 'middle right', 'Kitronik': 'middle right', 'SEEED': 'top right',
    'Adafruit': 'middle left', 'ANYSOLAR': 'bottom center', 'PowerFilm': 'top right',
}  # fmt: skip
TICKS: Final = (0.03, 0.05, 0.1, 0.2, 0.5)  # g/cm2
METHOD: Final = (
    'Areas are computed from the printed dimensions, taken as cm where mm would be impossible; '
    'masses are as printed. The paper states neither the light nor the capacitance of its '
    'charging test, so only the ratios of the times count.',
    'The harvest comes from a single-diode model of each data sheet at the temperature of '
    'the lit cells. The charger is that of the vehicle file. Most data-sheet numbers are '
    'assumed; each cell file states which.',
)


def build_report(table: CellTable, energy: EnergyBlock, budget: float) -> Report:
    """Return the report of a cell table; the budget is a mass. [kg]"""
    readings = list_readings(table)
    paper, fair = zip(*list_front_pairs(readings), strict=True)
    by_area = draw_fronts(
        readings, lambda each: each.charging_time_per_area / SQUARE, 's/cm²', paper
    )
    times_area = draw_fronts(
        readings, lambda each: each.charging_time_times_area * SQUARE, 's cm²', fair
    )
    return Report(
        command='cells',
        subject=table.name,
        headline=format_headline(paper, fair),
        introduction=table.about,
        tiles=build_tiles(table, energy),
        blocks=(
            Picture('paper', "The paper's criterion", PAPER, by_area),
            Picture('fair', 'A fair criterion', FAIR, times_area),
            build_ranking_table(table),
            build_array_table(table, energy),
            build_mass_budget_table(table, energy, budget),
            TextSection('Meaning and method', METHOD),
        ),
        data=to_json(table, energy, budget),
        facts={'table': table.name},
    )


def format_headline(*criteria: Sequence[Sequence[CellReading]]) -> str:
    """Return the makers on every Pareto front, and those on some, in one sentence."""
    fronts = [{each.row.maker for each in front} for fronts in criteria for front in fronts]
    always = set.intersection(*fronts)
    some = set.union(*fronts) - always
    text = f'No cell beats {" or ".join(sorted(always))} in both mass and charging time'
    if some:
        text += f'; whether {" and ".join(sorted(some))} can compete depends on the criterion'
    return f'{text}.'


def build_tiles(table: CellTable, energy: EnergyBlock) -> list[Tile]:
    """Return tiles with the stand-by net power of the paper's arrays in each light."""
    tiles = []
    for name, strings in build_all_arrays(table).items():
        for array in strings:
            for net in compute_net_powers(array, energy, table):
                size = f'{SQUARE * array.area:.0f} cm² of {name}'
                light = WORDS.get(net.light, net.light)
                tiles.append(
                    Tile(size, format_number(net.standby, 1, 1e3), 'mW', f'stand-by, {light}')
                )
    return tiles


def draw_fronts(
    entries: Sequence[CellReading],
    criterion: Criterion,
    unit: str,
    fronts: Sequence[Sequence[CellReading]],
) -> Figure:
    """Plot a criterion of the cells against mass per area, with the Pareto fronts."""
    figure = create_figure()
    for front, dash in zip(fronts, ('solid', '5px,4px'), strict=False):
        # The reading in which the fronts differ names them
        read = [each.title for each in front if each.readings > 1]
        figure.add_trace(
            Scatter(
                x=[_areal_mass(each) for each in front], y=[criterion(each) for each in front],
                mode='lines', line={'color': TRUTH, 'width': 1.6, 'dash': dash},
                name=', '.join(['Pareto front', *read]), hoverinfo='skip',
            )
        )  # fmt: skip
    # By identity: the fronts hold the same objects as `entries`.
    on = {id(each) for front in fronts for each in front}
    figure.add_trace(
        Scatter(
            x=[_areal_mass(each) for each in entries], y=[criterion(each) for each in entries],
            mode='markers+text', text=[each.title for each in entries],
            textposition=[SIDES.get(each.row.maker, 'top center') for each in entries],
            textfont={'color': SOFT, 'size': 11}, cliponaxis=False, showlegend=False,
            marker={
                'size': 9, 'color': [ESTIMATE if id(each) in on else SOFT for each in entries],
            },
            hovertemplate=f'%{{text}}: %{{x:.3f}} g/cm², %{{y:.3g}} {unit}<extra></extra>',
        )
    )  # fmt: skip
    for name, colour in (('cell on a front', ESTIMATE), ('other cell', SOFT)):
        # Only for the legend: one trace draws all cells
        dot = {'size': 9, 'color': colour}
        figure.add_trace(Scatter(x=[None], y=[None], mode='markers', name=name, marker=dot))
    add_legend(figure).update_layout(hovermode='closest')
    figure.update_xaxes(
        # On a logarithmic axis the range is in decades: 0.025 to 0.89 g/cm2.
        type='log',
        title_text='mass per area [g/cm²]',
        range=[-1.6, -0.05],
        tickvals=TICKS,
    )
    return figure.update_yaxes(type='log', title_text=f'charging time [{unit}]', dtick='D2')


def _areal_mass(each: CellReading) -> float:
    return each.areal_mass * GRAMS / SQUARE
