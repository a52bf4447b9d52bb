# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a comparison of solar cells and arrays."""

from collections.abc import Sequence
from typing import Any, Final

from lta_config.schema.cell_file import CellFile, CellTable
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_report.charts import ChartAxis, Curve, draw_curves
from lta_report.formatting import format_number, MISSING, Tile
from lta_report.palette import ESTIMATE, SOFT, TRUTH
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_studies.energy.cells.arrays import (
    build_all_arrays,
    CellArray,
    CellReading,
    compute_net_powers,
    Criterion,
    find_largest_array,
    find_pareto_front,
    has_printed_signs,
    list_readings,
    NetPower,
    select_readings,
)
from plotly.graph_objects import Figure

GRAMS: Final = 1e3
SQUARE: Final = 1e4  # cm2 per m2
FRONTS: Final = ('paper', 'fair')
SHEET: Final = (
    's/cm²: charging time per area, the criterion of the paper. s cm²: charging time times '
    'area, the fair criterion. sheet: charging time computed from the short-circuit currents '
    'of the cell files (assumed where no data sheet gives one), in sunlight and relative to the '
    'fastest cell (a capacitor far below the open-circuit '
    'voltage draws about this current). front: the criteria by which the cell is on the Pareto '
    'front; if the row of the paper can mean several panels, one of them is enough.'
)
CHARGED: Final = (
    'harvest: maximum power of the array. charged: output of the charger. idle and sending: '
    'output of the charger minus the loads in stand-by and while transmitting. printed: '
    'sign of the net power in the paper; "not" marks a different sign here.'
)
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


def build_ranking_table(table: CellTable) -> TextTable:
    """Return the table of cells with both criteria and the fronts they are on."""
    readings = list_readings(table)
    fronts = list_front_pairs(readings)
    heads = ('cell', 'cm²', 'g/cm²', 's', 'sheet', 's/cm²', 's cm²', 'g s', 'front')
    rows = []
    for each in readings:
        on = [
            word
            for place, word in enumerate(FRONTS)
            if any(each in pair[place] for pair in fronts)
        ]
        rows.append([
            each.title,
            format_number(each.cell.area, 1, SQUARE),
            format_number(each.areal_mass, 3, GRAMS / SQUARE),
            format_number(each.row.charge.si, 1),
            format_number(datasheet_charging_time(each, readings), 1),
            format_number(each.charging_time_per_area, 3, 1.0 / SQUARE),
            format_number(each.charging_time_times_area, 0, SQUARE),
            format_number(each.charging_time_times_mass, 0, GRAMS),
            'both' if len(on) == len(FRONTS) else ''.join(on) or MISSING,
        ])  # fmt: skip
    return TextTable(
        'Cells of the table', heads, rows, ' '.join([SHEET, *describe_defects(table)])
    )


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


def build_array_table(table: CellTable, energy: EnergyBlock) -> TextTable:
    """Return the table of the paper's arrays, compared with the printed signs."""
    klux = table.arrays.illuminance.si / 1e3
    heads = ('array', 'light', 'W/m²', 'harvest', 'charged', 'idle', 'sending', 'printed')
    rows = []
    for name, strings in build_all_arrays(table).items():
        built = table.arrays.built[name]
        for array in strings:
            for net in compute_net_powers(array, energy, table):
                prefix = '' if has_printed_signs(net, built) else 'not '
                light = LIGHT_WORDS.get(net.light, net.light)
                rows.append(
                    [
                        format_array(array),
                        light,
                        *format_net_power(net),
                        f'{prefix}{built.standby}',
                    ]
                )
    heading = f'Arrays of the paper at {klux:g} klx, power in mW'
    return TextTable(heading, heads, rows, CHARGED)


def format_net_power(net: NetPower) -> list[str]:
    """Format irradiance [W/m2] and powers [mW]."""
    powers = (net.harvest, net.charger, net.standby, net.transmitting)
    return [format_number(net.irradiance, 0), *(format_number(power, 1, 1e3) for power in powers)]


def format_array(array: CellArray) -> str:
    """Format an array, for example '2S1P anysolar'."""
    return f'{array.series}S{array.parallel}P {array.cell.name}'


def build_mass_budget_table(table: CellTable, energy: EnergyBlock, budget: float) -> TextTable:
    """Return the table of the largest array of each cell within a mass [kg]."""
    lights = table.lights
    heads = (
        'array',
        'g',
        'cm²',
        'rated [W]',
        *(LIGHT_WORDS.get(light, light) for light in lights),
    )
    rows = []
    for cell in list_cells(table):
        array = find_largest_array(cell, budget)
        if array is None:
            # Mass, area and rated power, and one column per light
            rows.append([f'{cell.name}: too heavy', *[MISSING] * (3 + len(lights))])
            continue
        powers = compute_net_powers(array, energy, table)
        rated = array.panel_count * cell.rated_power
        rows.append([
            format_array(array), format_number(array.mass, 1, GRAMS),
            format_number(array.area, 0, SQUARE), format_number(rated, 2),
            *(format_number(net.standby, 1, 1e3) for net in powers),
        ])  # fmt: skip
    klux = table.arrays.illuminance.si / 1e3
    heading = f'Arrays within {GRAMS * budget:g} g: net power in stand-by at {klux:g} klx, in mW'
    return TextTable(heading, heads, rows)


def list_cells(table: CellTable) -> list[CellFile]:
    """Return the cells of a table."""
    return [each.cell for each in list_readings(table)]


def to_json(table: CellTable, energy: EnergyBlock, budget: float) -> dict[str, Any]:
    """Convert the comparison to JSON, in SI units."""
    readings = list_readings(table)
    return {
        'cells': {
            each.cell.name: {
                'area': each.cell.area, 'mass': each.cell.mass.si, 'areal_mass': each.areal_mass,
                'charge': each.row.charge.si, 'charge_by_area': each.charging_time_per_area,
                'charge_times_area': each.charging_time_times_area,
                'charge_times_mass': each.charging_time_times_mass,
            }
            for each in readings
        },
        'fronts': [
            {
                name: [each.cell.name for each in front]
                for name, front in zip(FRONTS, pair, strict=True)
            }
            for pair in list_front_pairs(readings)
        ],
        'arrays': [
            {'cell': array.cell.name, 'series': array.series, 'parallel': array.parallel,
             'agrees': has_printed_signs(net, table.arrays.built[name]), **_net_power_to_json(net)}
            for name, strings in build_all_arrays(table).items()
            for array in strings
            for net in compute_net_powers(array, energy, table)
        ],
        'budget': budget,
        'within': {
            cell.name: None if array is None else {
                'series': array.series, 'parallel': array.parallel, 'mass': array.mass,
                'area': array.area,
                'net': [
                    _net_power_to_json(net) for net in compute_net_powers(array, energy, table)
                ],
            }
            for cell in list_cells(table)
            # A loop over one value names it within the comprehension.
            for array in (find_largest_array(cell, budget),)
        },
    }  # fmt: skip


def _net_power_to_json(net: NetPower) -> dict[str, float | str]:
    return {
        'light': net.light, 'irradiance': net.irradiance, 'harvest': net.harvest,
        'given': net.charger, 'standby': net.standby, 'transmitting': net.transmitting,
    }  # fmt: skip


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
            Picture('paper', "The paper's criterion", PAPER_CRITERION, by_area),
            Picture('fair', 'A fair criterion', FAIR_CRITERION, times_area),
            build_ranking_table(table),
            build_array_table(table, energy),
            build_mass_budget_table(table, energy, budget),
            TextSection('Meaning and method', CELLS_METHOD),
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
                light = LIGHT_WORDS.get(net.light, net.light)
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
