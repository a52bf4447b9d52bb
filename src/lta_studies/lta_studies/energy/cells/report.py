# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a comparison of solar cells and arrays."""

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

from lta_config.schema.cell_file import CellFile, CellTable
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_report.charts import ChartAxis, Curve, draw_curves
from lta_report.formatting import format_number, Tile
from lta_report.palette import ESTIMATE, SOFT, TRUTH
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_report.result_table import build_table, Column, to_record
from lta_studies.energy.cells.arrays import (
    build_all_arrays,
    CellArray,
    CellReading,
    compute_net_powers,
    Criterion,
    find_largest_array,
    find_pareto_front,
    list_readings,
    NetPower,
    select_readings,
)
from plotly.graph_objects import Figure

GRAMS: Final = 1e3
SQUARE: Final = 1e4  # cm2 per m2
FRONTS: Final = ('paper', 'fair')
LIGHT_WORDS: Final = {'white_led': 'LED', 'sun': 'sun'}


def find_fronts_by_criterion(
    entries: Sequence[CellReading], which: int
) -> tuple[list[CellReading], list[CellReading]]:
    """Return the fronts by the paper's and the fair criterion, for one reading of the rows."""
    rows = select_readings(entries, which)
    return find_pareto_front(rows, lambda each: each.charging_time_per_area), find_pareto_front(
        rows, lambda each: each.charging_time_times_area
    )


def list_front_pairs(
    entries: Sequence[CellReading],
) -> list[tuple[list[CellReading], list[CellReading]]]:
    """Return one pair of fronts for each reading of the ambiguous rows."""
    count = max(each.readings for each in entries)
    return [find_fronts_by_criterion(entries, which) for which in range(count)]


def list_ranking_columns(readings: Sequence[CellReading]) -> tuple[Column[CellReading], ...]:
    """Return the columns of the cells, which compare each with all of them."""
    pairs = list_front_pairs(readings)

    def name_fronts(each: CellReading) -> str:
        on = [name for k, name in enumerate(FRONTS) if any(each in pair[k] for pair in pairs)]
        return 'both' if len(on) == len(FRONTS) else ''.join(on)

    return (
        Column('', 'cell', of=lambda each: each.title),
        Column('area', 'cm²', digits=1, of=lambda each: each.cell.area, factor=SQUARE),
        Column('mass', of=lambda each: each.cell.mass.si),
        Column('areal_mass', 'g/cm²', digits=3, factor=GRAMS / SQUARE),
        Column('charge', 's', digits=1, of=lambda each: each.row.charge.si),
        Column('', 'sheet', digits=1, of=lambda each: datasheet_charging_time(each, readings),
               meaning='charging time computed from the short-circuit currents of the cell files '
                       '(assumed where no data sheet gives one), in sunlight and relative to the '
                       'fastest cell (a capacitor far below the open-circuit voltage draws about '
                       'this current)'),
        Column('charge_by_area', 's/cm²', digits=3, of=lambda each: each.charging_time_per_area,
               factor=1.0 / SQUARE,
               meaning='charging time per area, the criterion of the paper'),
        Column('charge_times_area', 's cm²', digits=0, factor=SQUARE,
               of=lambda each: each.charging_time_times_area,
               meaning='charging time times area, the fair criterion'),
        Column('charge_times_mass', 'g s', digits=0, factor=GRAMS,
               of=lambda each: each.charging_time_times_mass),
        Column('', 'front', of=name_fronts,
               meaning='the criteria by which the cell is on the Pareto front; if the row of the '
                       'paper can mean several panels, one of them is enough'),
    )  # fmt: skip


def datasheet_charging_time(each: CellReading, entries: Sequence[CellReading]) -> float:
    """Return the charging time by short-circuit current, relative to the fastest cell [s]."""
    first = min(entries, key=lambda entry: entry.row.charge.si)
    # Charging a capacitor takes Q / I, so times are inverse to the short-circuit currents.
    currents = [entry.cell.electrical.short_circuit.si for entry in (first, each)]
    return first.row.charge.si * currents[0] / currents[1]


def describe_defects(table: CellTable) -> list[str]:
    """Return a sentence for each defect of the printed table."""
    defects = [(row.maker, each) for row in table.rows.values() for each in row.defects]
    defects += [
        (f'The array {n}', d) for n, built in table.arrays.built.items() for d in built.defects
    ]
    return [f'{who}: {what}.' for who, what in defects]


NET_COLUMNS: Final[tuple[Column[NetPower], ...]] = (
    Column('light', of=lambda net: net.light),
    Column('', 'light', of=lambda net: format_light(net.light)),
    Column('irradiance', 'W/m²', digits=0),
    Column('harvest', 'harvest', '', 1, None, 1e3, 'maximum power of the array'),
    Column('given', 'charged', '', 1, lambda net: net.charger, 1e3, 'output of the charger'),
    Column('standby', 'idle', '', 1, None, 1e3,
           'output of the charger minus the loads in stand-by'),
    Column('transmitting', 'sending', '', 1, None, 1e3,
           'output of the charger minus the loads while transmitting'),
)  # fmt: skip
ARRAY_COLUMNS: Final[tuple[Column[NetPower], ...]] = (
    Column('', 'array', of=lambda net: format_array(net.array)),
    Column('cell', of=lambda net: net.array.cell.name),
    Column('series', of=lambda net: net.array.series),
    Column('parallel', of=lambda net: net.array.parallel),
    Column('agrees', of=lambda net: net.has_printed_signs),
    *NET_COLUMNS,
    Column('', 'printed', of=lambda net: format_printed_sign(net),
           meaning='sign of the net power in the paper; "not" marks a different sign here'),
)  # fmt: skip


def format_printed_sign(net: NetPower) -> str:
    """Return the sign of the paper, with "not" before a different one."""
    assert net.array.printed is not None
    return ('' if net.has_printed_signs else 'not ') + net.array.printed.standby


def list_printed_powers(table: CellTable, energy: EnergyBlock) -> list[NetPower]:
    """Return the net power of the paper's arrays in each light."""
    return [
        net
        for arrays in build_all_arrays(table).values()
        for array in arrays
        for net in compute_net_powers(array, energy, table)
    ]


def build_array_table(table: CellTable, energy: EnergyBlock) -> TextTable:
    """Return the table of the paper's arrays, compared with the printed signs."""
    heading = f'Arrays of the paper at {format_klux(table)}, power in mW'
    return build_table(heading, ARRAY_COLUMNS, list_printed_powers(table, energy))


def format_klux(table: CellTable) -> str:
    """Return the illuminance of the arrays."""
    return f'{table.arrays.illuminance.si / 1e3:g} klx'


def format_light(light: str) -> str:
    """Return the name of a light in tables."""
    return LIGHT_WORDS.get(light, light)


def format_array(array: CellArray) -> str:
    """Format an array, for example '2S1P anysolar'."""
    return f'{array.series}S{array.parallel}P {array.cell.name}'


class LargestArray(NamedTuple):
    """The largest array of a cell within a mass, and its net power in each light."""

    cell: CellFile
    array: CellArray | None  # None if one string is too heavy
    nets: Sequence[NetPower]


LARGEST_COLUMNS: Final[tuple[Column[LargestArray], ...]] = (
    Column('', 'array', of=lambda row: format_array(row.array) if row.array
           else f'{row.cell.name}: too heavy'),
    Column('series', of=lambda row: row.array and row.array.series),
    Column('parallel', of=lambda row: row.array and row.array.parallel),
    Column('mass', 'g', digits=1, of=lambda row: row.array and row.array.mass, factor=GRAMS),
    Column('area', 'cm²', digits=0, of=lambda row: row.array and row.array.area, factor=SQUARE),
    Column('', 'rated [W]', digits=2,
           of=lambda row: row.array and row.array.panel_count * row.cell.rated_power),
    Column('net', of=lambda row: [to_record(NET_COLUMNS, net) for net in row.nets]),
)  # fmt: skip


def list_largest_arrays(
    table: CellTable, energy: EnergyBlock, budget: float
) -> list[LargestArray]:
    """Return the largest array of each cell within a mass [kg]."""
    cells = [each.cell for each in list_readings(table)]
    arrays = [find_largest_array(cell, budget) for cell in cells]
    return [
        LargestArray(cell, array, compute_net_powers(array, energy, table) if array else ())
        for cell, array in zip(cells, arrays, strict=True)
    ]


def build_mass_budget_table(
    table: CellTable, largest: Sequence[LargestArray], budget: float
) -> TextTable:
    """Return the table of the largest array of each cell within a mass [kg]."""

    def light_column(place: int, light: str) -> Column[LargestArray]:
        def find_standby(row: LargestArray) -> float | None:
            return row.nets[place].standby if row.nets else None

        return Column('', format_light(light), '', 1, find_standby, 1e3)

    lights = [light_column(*each) for each in enumerate(table.lights)]
    heading = (
        f'Arrays within {GRAMS * budget:g} g: net power in stand-by at {format_klux(table)}, in mW'
    )
    return build_table(heading, (*LARGEST_COLUMNS, *lights), largest)


PAPER_CRITERION: Final = (
    'Charging time per area against mass per area, the criterion of the paper (Huang et al. '
    '2025). The paper does not say which size of PowerFilm panel it measured: the full line '
    'is the front with the small panel, the dashed line with the large one. The criterion '
    'favours large cells twice: they charge faster, and the time is divided by a larger area.'
)
FAIR_CRITERION: Final = (
    'Charging time times area, which does not depend on the size of a panel, against mass '
    'per area. Full line: PowerFilm read as the panel of 53.9 cm² that is named; dashed: as '
    'the size of 266.3 cm² that is printed. This choice decides whether the cell Dracula is '
    'on the Pareto front.'
)
# Label positions that keep the names of neighbours apart.
LABEL_SIDES: Final = {
    'Dracula': 'middle right', 'Kitronik': 'middle right', 'SEEED': 'top right',
    'Adafruit': 'middle left', 'ANYSOLAR': 'bottom center', 'PowerFilm': 'top right',
}  # fmt: skip
MASS_TICKS: Final = (0.03, 0.05, 0.1, 0.2, 0.5)  # g/cm2
CELLS_METHOD: Final = (
    'Areas are computed from the printed dimensions, taken as cm where mm would be impossible; '
    'masses are as printed. The paper states neither the light nor the capacitance of its '
    'charging test, so only the ratios of the times count.',
    'The harvest comes from a single-diode model of each data sheet at the temperature of '
    'the lit cells. The charger is that of the vehicle file. Most data-sheet numbers are '
    'assumed; each cell file states which.',
)


def build_report(table: CellTable, energy: EnergyBlock, budget: float) -> Report:
    """Return the report of a cell table; the budget is a mass [kg]."""
    readings = list_readings(table)
    columns, pairs = list_ranking_columns(readings), list_front_pairs(readings)
    largest = list_largest_arrays(table, energy, budget)
    paper, fair = zip(*pairs, strict=True)
    by_area = draw_fronts(
        readings, lambda each: each.charging_time_per_area / SQUARE, 's/cm²', paper
    )
    times_area = draw_fronts(
        readings, lambda each: each.charging_time_times_area * SQUARE, 's cm²', fair
    )
    defects = ' '.join(describe_defects(table))
    return Report(
        command='cells',
        subject=table.name,
        headline=format_headline(paper, fair),
        introduction=table.about,
        tiles=[
            Tile(f'{SQUARE * array.area:.0f} cm² of {name}',
                 format_number(net.standby, 1, 1e3), 'mW', f'stand-by, {format_light(net.light)}')
            for name, arrays in build_all_arrays(table).items()
            for array in arrays
            for net in compute_net_powers(array, energy, table)
        ],
        blocks=(
            Picture('paper', "The paper's criterion", PAPER_CRITERION, by_area),
            Picture('fair', 'A fair criterion', FAIR_CRITERION, times_area),
            build_table('Cells of the table', columns, readings, defects),
            build_array_table(table, energy),
            build_mass_budget_table(table, largest, budget),
            TextSection('Meaning and method', CELLS_METHOD),
        ),
        data={
            'cells': {each.cell.name: to_record(columns, each) for each in readings},
            'fronts': [
                {
                    name: [each.cell.name for each in front]
                    for name, front in zip(FRONTS, pair, strict=True)
                }
                for pair in pairs
            ],
            'arrays': [
                to_record(ARRAY_COLUMNS, each) for each in list_printed_powers(table, energy)
            ],
            'budget': budget,
            'within': {
                each.cell.name: to_record(LARGEST_COLUMNS, each) if each.array else None
                for each in largest
            },
        },
        facts={'table': table.name},
    )  # fmt: skip


def format_headline(*criteria: Sequence[Sequence[CellReading]]) -> str:
    """Return the makers on every Pareto front, and those on some, in one sentence."""
    fronts = [{each.row.maker for each in front} for fronts in criteria for front in fronts]
    always = set.intersection(*fronts)
    some = set.union(*fronts) - always
    text = f'No cell beats {" or ".join(sorted(always))} in both mass and charging time'
    if some:
        text += f'; whether {" and ".join(sorted(some))} can compete depends on the criterion'
    return f'{text}.'


def draw_fronts(
    entries: Sequence[CellReading],
    criterion: Criterion,
    unit: str,
    fronts: Sequence[Sequence[CellReading]],
) -> Figure:
    """Plot a criterion of the cells against mass per area, with the Pareto fronts."""

    def plot(name: str, cells: Sequence[CellReading], colour: str, **look: Any) -> Curve:
        x, y = [_areal_mass(each) for each in cells], [criterion(each) for each in cells]
        return Curve(name, x, y, colour, **look)

    curves = []
    for front, dash in zip(fronts, ('solid', '5px,4px'), strict=False):
        # The reading in which the fronts differ names them
        read = [each.title for each in front if each.readings > 1]
        name = ', '.join(['Pareto front', *read])
        curves.append(plot(name, front, TRUTH, dash=dash, hover='', more={'hoverinfo': 'skip'}))
    # By identity: the fronts hold the same objects as `entries`.
    on = {id(each) for front in fronts for each in front}
    hover = f'%{{text}}: %{{x:.3f}} g/cm², %{{y:.3g}} {unit}<extra></extra>'
    for name, colour, is_on in (('cell on a front', ESTIMATE, True), ('other cell', SOFT, False)):
        cells = [each for each in entries if (id(each) in on) == is_on]
        words = {
            'mode': 'markers+text', 'text': [each.title for each in cells], 'cliponaxis': False,
            'textposition': [LABEL_SIDES.get(each.row.maker, 'top center') for each in cells],
            'textfont': {'color': SOFT, 'size': 11},
        }  # fmt: skip
        curves.append(plot(name, cells, colour, size=9, hover=hover, more=words))
    # On a logarithmic axis the range is in decades: 0.025 to 0.89 g/cm2
    mass = ChartAxis('mass per area [g/cm²]', log=True, range=(-1.6, -0.05), ticks=MASS_TICKS)
    time = ChartAxis(f'charging time [{unit}]', log=True, more={'dtick': 'D2'})
    return draw_curves(curves, mass, time).update_layout(hovermode='closest')


def _areal_mass(each: CellReading) -> float:
    return each.areal_mass * GRAMS / SQUARE
