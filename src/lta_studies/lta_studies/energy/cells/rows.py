"""Cells and arrays as tables of text and as plain data."""

from collections.abc import Sequence
from typing import Any, Final

from lta_config.schema.cell_file import CellFile
from lta_config.schema.cell_table import CellTable
from lta_config.schema.vehicle_energy import Energy
from lta_report.formatting import MISSING, number
from lta_studies.energy.cells.ranked import entries, Entry, front, read_as
from lta_studies.energy.cells.strung import agrees, all_built, Net, nets, Strung, within
from lta_studies.energy.tables import Table

GRAMS: Final = 1e3
SQUARE: Final = 1e4  # cm2 of a m2
FRONTS: Final = ('paper', 'fair')
SHEET: Final = (
    's/cm² is the figure of the paper, s cm² the fair one. A capacitor far below the open-circuit '
    'voltage takes the short-circuit current: "sheet" is the time that the data sheets give, '
    'from that of the quickest cell. Front: on which that cell is, in either reading.'
)
CHARGED: Final = (
    'Harvest is the largest power of the array, charged what the charger makes of it; stand-by '
    '(idle) and sending what is left after the loads. "Not" marks what differs from the paper.'
)
WORDS: Final = {'white_led': 'LED', 'sunlight': 'sun'}


def both_fronts(found: Sequence[Entry], which: int) -> tuple[list[Entry], list[Entry]]:
    """Return the paper's front and the fair one, for one reading of the rows."""
    rows = read_as(found, which)
    return front(rows, lambda each: each.by_area), front(rows, lambda each: each.times_area)


def ranking(table: CellTable) -> Table:
    """Return the cells with both figures; a reading on a front says on which."""
    found = entries(table)
    fronts = [both_fronts(found, which) for which in range(max(each.readings for each in found))]
    heads = ('cell', 'cm²', 'g/cm²', 's', 'sheet', 's/cm²', 's cm²', 'g s', 'front')
    rows = []
    for each in found:
        on = [
            word
            for place, word in enumerate(FRONTS)
            if any(each in pair[place] for pair in fronts)
        ]
        rows.append([
            each.title,
            number(each.cell.area, 1, SQUARE),
            number(each.areal_mass, 3, GRAMS / SQUARE),
            number(each.row.charge.si, 1),
            number(by_sheet(each, found), 1),
            number(each.by_area, 3, 1.0 / SQUARE),
            number(each.times_area, 0, SQUARE),
            number(each.times_mass, 0, GRAMS),
            'both' if len(on) == len(FRONTS) else ''.join(on) or MISSING,
        ])  # fmt: skip
    return Table('Cells of the table', heads, rows, ' '.join([SHEET, *defects(table)]))


def by_sheet(each: Entry, found: Sequence[Entry]) -> float:
    """Return the charging time by the short-circuit currents, from that of the quickest. [s]"""
    first = min(found, key=lambda entry: entry.row.charge.si)
    currents = [entry.cell.electrical.short_circuit.si for entry in (first, each)]
    return first.row.charge.si * currents[0] / currents[1]


def defects(table: CellTable) -> list[str]:
    """Return what does not add up, a sentence each."""
    told = [(row.maker, each) for row in table.rows.values() for each in row.defects]
    told += [
        (f'The array {n}', d) for n, built in table.arrays.built.items() for d in built.defects
    ]
    return [f'{who}: {what}.' for who, what in told]


def trial(table: CellTable, energy: Energy) -> Table:
    """Return the arrays that were built beside what is printed of them."""
    klux = table.arrays.illuminance.si / 1e3
    heads = ('array', 'light', 'W/m²', 'harvest', 'charged', 'idle', 'sending', 'printed')
    rows = []
    for name, strings in all_built(table).items():
        built = table.arrays.built[name]
        for strung in strings:
            for net in nets(strung, energy, table):
                told = '' if agrees(net, built) else 'not '
                light = WORDS.get(net.light, net.light)
                rows.append([titled(strung), light, *watts(net), f'{told}{built.standby}'])
    heading = f'Arrays of the paper at {klux:g} klux, power in mW'
    return Table(heading, heads, rows, CHARGED)


def watts(net: Net) -> list[str]:
    """Return irradiance and powers as text. [W/m2, mW]"""
    powers = (net.harvest, net.given, net.standby, net.transmitting)
    return [number(net.irradiance, 0), *(number(power, 1, 1e3) for power in powers)]


def titled(strung: Strung) -> str:
    """Return an array in words."""
    return f'{strung.series}S{strung.parallel}P {strung.cell.name}'


def afforded(table: CellTable, energy: Energy, budget: float) -> Table:
    """Return the largest array of each cell within a mass. [kg]"""
    lights = list(table.lights)
    heads = ('array', 'g', 'cm²', 'rated [W]', *(WORDS.get(light, light) for light in lights))
    rows = []
    for cell in cells(table):
        strung = within(cell, budget)
        if strung is None:
            rows.append([f'{cell.name}: too heavy', *[MISSING] * (3 + len(lights))])
            continue
        found = nets(strung, energy, table)
        rated = strung.count * cell.rated
        rows.append([
            titled(strung), number(strung.mass, 1, GRAMS), number(strung.area, 0, SQUARE),
            number(rated, 2), *(number(net.standby, 1, 1e3) for net in found),
        ])  # fmt: skip
    klux = table.arrays.illuminance.si / 1e3
    heading = f'Arrays within {GRAMS * budget:g} g: net power in stand-by at {klux:g} klux, mW'
    return Table(heading, heads, rows)


def cells(table: CellTable) -> list[CellFile]:
    """Return the cells of a table."""
    return [each.cell for each in entries(table)]


def plain(table: CellTable, energy: Energy, budget: float) -> dict[str, Any]:
    """Return all of it as JSON has it: SI units."""
    found = entries(table)
    return {
        'cells': {
            each.cell.name: {
                'area': each.cell.area, 'mass': each.cell.mass.si, 'areal_mass': each.areal_mass,
                'charge': each.row.charge.si, 'charge_by_area': each.by_area,
                'charge_times_area': each.times_area, 'charge_times_mass': each.times_mass,
            }
            for each in found
        },
        'fronts': [
            {
                name: [each.cell.name for each in kept]
                for name, kept in zip(FRONTS, both_fronts(found, which), strict=True)
            }
            for which in range(max(each.readings for each in found))
        ],
        'arrays': [
            {'cell': strung.cell.name, 'series': strung.series, 'parallel': strung.parallel,
             'agrees': agrees(net, table.arrays.built[name]), **_net(net)}
            for name, strings in all_built(table).items()
            for strung in strings
            for net in nets(strung, energy, table)
        ],
        'budget': budget,
        'within': {
            cell.name: None if strung is None else {
                'series': strung.series, 'parallel': strung.parallel, 'mass': strung.mass,
                'area': strung.area, 'net': [_net(net) for net in nets(strung, energy, table)],
            }
            for cell in cells(table)
            for strung in (within(cell, budget),)
        },
    }  # fmt: skip


def _net(net: Net) -> dict[str, float | str]:
    return {
        'light': net.light, 'irradiance': net.irradiance, 'harvest': net.harvest,
        'given': net.given, 'standby': net.standby, 'transmitting': net.transmitting,
    }  # fmt: skip
