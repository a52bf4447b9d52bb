"""Solar cells: the paper's table computed again, its front, and its arrays at 18 klux."""

from collections.abc import Sequence
from statistics import geometric_mean

from lta_config.schema.cell_table import CellTable, load_cell_table
from lta_config.schema.vehicle_energy import Energy
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.typed import typed
from lta_energy.breakeven import break_even, Lamp
from lta_energy.harvest import Harvest
from lta_model.electrical.panel import Panel
from lta_model.electrical.power_path import Charger
from lta_studies.energy.cells.page import FAIR, PAPER, picture
from lta_studies.energy.cells.ranked import entries, Entry, read_as
from lta_studies.energy.cells.rows import both_fronts, by_sheet, SQUARE, trial
from lta_studies.energy.cells.strung import all_built, loads, Net, nets
from lta_studies.reproduce.found import Asked, Found, Picture, Value

READINGS = ('small', 'large')  # of the PowerFilm row, as the table's file lists them
CRYSTALLINE = ('adafruit', 'seeed', 'kitronik')
LIGHTS = {'white_led': 'led', 'sunlight': 'sun'}


def study(asked: Asked) -> Found:
    """Return the cells and arrays of the paper's table; chance has no part in it."""
    del asked
    table = load_cell_table('seed_paper')
    energy = load_vehicle_file('gtmab').energy
    found = entries(table)
    fronts = [both_fronts(found, which) for which in range(len(READINGS))]
    values = {**offsets(found), **sheets(found), **arrays(table, energy), **factor(found)}
    for reading, (paper, fair) in zip(READINGS, fronts, strict=True):
        values[f'front_{reading}'] = makers(paper)
        values[f'fair_front_{reading}'] = makers(fair)
    by_paper, fairly = zip(*fronts, strict=True)
    command = typed('cells')
    pictures = [
        Picture('front', 'As the paper counts', PAPER,
                picture(found, lambda each: each.by_area / SQUARE, 's/cm²', by_paper), command),
        Picture('fair', 'As is fair', FAIR,
                picture(found, lambda each: each.times_area * SQUARE, 's cm²', fairly), command),
    ]  # fmt: skip
    return Found(values, pictures, [trial(table, energy)])


def makers(front: Sequence[Entry]) -> Value:
    """Return who is on a front, the lightest first."""
    return Value(', '.join(each.row.maker for each in front))


def offsets(found: Sequence[Entry]) -> dict[str, Value]:
    """Return how far the printed quotients are from what size, mass and time make of them."""
    worst = {}
    for which, reading in enumerate(READINGS):
        rows = read_as(found, which)
        worst[f'mass_off_{reading}'] = Value(
            max(abs(each.areal_mass / each.row.areal_mass.si - 1.0) for each in rows)
        )
        worst[f'time_off_{reading}'] = Value(
            max(abs(each.by_area / each.row.areal_charge.si - 1.0) for each in rows)
        )
    return worst


def sheets(found: Sequence[Entry]) -> dict[str, Value]:
    """Return the charging times that the data sheets give, by ANYSOLAR's."""
    return {
        f'sheet_{each.cell.name}': Value(by_sheet(each, found))
        for each in found
        if each.cell.name not in ('anysolar', 'dracula')  # the first is the measure of the others
    }


def factor(found: Sequence[Entry]) -> dict[str, Value]:
    """Return by how much the printed times exceed those of the sheets, and how well that holds."""
    by = {each.cell.name: each.row.charge.si / by_sheet(each, found) for each in found}
    alike = [by[name] for name in CRYSTALLINE]
    worst = max(
        abs(geometric_mean([x for x in alike if x is not each]) / each - 1.0) for each in alike
    )
    return {
        'sheet_factor': Value(geometric_mean(alike)),
        'sheet_worst': Value(worst),
        'sheet_amorphous': Value(by['powerfilm_small']),
    }


def arrays(table: CellTable, energy: Energy) -> dict[str, Value]:
    """Return what each array leaves, in stand-by and transmitting, by reading and light."""
    values: dict[str, Value] = {}
    for strings in all_built(table).values():
        for strung in strings:
            for net in nets(strung, energy, table):
                values |= left(f'{strung.cell.name}_{LIGHTS[net.light]}', net)
    led, sun = (table.lights[name].si for name in LIGHTS)
    light = table.arrays.illuminance.si
    panel = Harvest(Panel.wired('anysolar', 2, 1))
    for task, load in zip(('standby', 'transmitting'), loads(energy), strict=True):
        even = break_even(panel, Charger.of(energy), Lamp(led, 1.0), load)
        values[f'light_for_{task}'] = Value(even / light)
    return {**values, 'sun_by_led': Value(led / sun)}


def left(name: str, net: Net) -> dict[str, Value]:
    """Return net powers under names of their own."""
    return {
        f'{name}_standby': Value(net.standby),
        f'{name}_transmitting': Value(net.transmitting),
    }
