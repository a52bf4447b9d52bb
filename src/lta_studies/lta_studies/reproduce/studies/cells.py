# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Recompute the paper's table of solar cells, its Pareto front, and arrays at 18 klux."""

from collections.abc import Sequence
from dataclasses import replace

from lta_config.command_line import format_lta_command
from lta_config.files import find_file, load_yaml, validate_content
from lta_config.parameter_override import draw_between, draw_content
from lta_config.schema.cell_file import CellFile, CellTable, load_cell_table
from lta_config.schema.spectrum_file import load_spectrum, luminous_efficacy
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_config.schema.vehicle_file import load_vehicle_file, VehicleFile
from lta_energy.harvest import break_even_illuminance, HarvestCurve, LAMPS
from lta_model.electrical.mppt_charger import ChargerModel
from lta_studies.energy.cells.arrays import (
    build_all_arrays,
    CellReading,
    compute_ground_loads,
    compute_net_powers,
    list_readings,
    NetPower,
    select_readings,
)
from lta_studies.energy.cells.report import (
    build_array_table,
    datasheet_charging_time,
    draw_fronts,
    FAIR_CRITERION,
    find_fronts_by_criterion,
    list_printed_powers,
    PAPER_CRITERION,
    SQUARE,
)
from lta_studies.reproduce.study_result import (
    collect_draws,
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
)

POWERFILM_READINGS = ('small', 'large')  # of the PowerFilm row, as the table's file lists them
CELL_LIGHTS = {'white_led': 'led', 'sun': 'sun'}


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Evaluate the cells and arrays of the paper's table."""
    table = load_cell_table('seed_paper')
    energy = load_vehicle_file('gtmab').energy
    readings = list_readings(table)
    fronts = [
        find_fronts_by_criterion(readings, which) for which in range(len(POWERFILM_READINGS))
    ]
    values = {
        **quotient_errors(readings),
        **data_sheet_times(readings),
        **compute_array_power(table, energy),
    }
    for reading, (paper, fair) in zip(POWERFILM_READINGS, fronts, strict=True):
        values[f'front_{reading}'] = list_makers(paper)
        values[f'fair_front_{reading}'] = list_makers(fair)
    by_paper, fairly = zip(*fronts, strict=True)
    command = format_lta_command('cells')
    pictures = [
        StudyPicture('front', "The paper's criterion", PAPER_CRITERION,
                     draw_fronts(readings, lambda each: each.charging_time_per_area / SQUARE,
                                 's/cm²', by_paper), command),
        StudyPicture('fair', 'A fair criterion', FAIR_CRITERION,
                     draw_fronts(readings, lambda each: each.charging_time_times_area * SQUARE,
                                 's cm²', fairly), command),
    ]  # fmt: skip
    draws = collect_draws(request, lambda seed: measure_draw(table, seed))
    return RowStudyResult(values, pictures, [build_array_table(table, energy)], draws)


def measure_draw(table: CellTable, seed: int) -> dict[str, float | str]:
    """Return the measures with cells, charger and loads drawn from their ranges."""
    content = draw_content(load_yaml(find_file('vehicle', 'gtmab')), seed, 'vehicle')
    energy = validate_content(VehicleFile, content, 'a draw of gtmab').energy
    readings = [
        replace(each, cell=draw_cell(each.cell.name, seed)) for each in list_readings(table)
    ]
    values = data_sheet_times(readings)
    efficacies = {light: draw_efficacy(light, seed) for light in table.lights}
    for strings in build_all_arrays(table).values():
        for array in strings:
            sample = replace(array, cell=draw_cell(array.cell.name, seed))
            for net in compute_net_powers(sample, energy, table, efficacies):
                values |= label_net_powers(net)
    return {name: value.value for name, value in values.items()}


def draw_cell(name: str, seed: int) -> CellFile:
    """Return a cell file with its assumed numbers drawn from their ranges."""
    content = draw_content(load_yaml(find_file('cell', name)), seed, 'cell')
    return validate_content(CellFile, content, f'a draw of {name}')


def draw_efficacy(light: str, seed: int) -> float:
    """Return a luminous efficacy from the range of a shipped spectrum [lm/W]."""
    among = load_spectrum(light).efficacy
    if among is None:
        return luminous_efficacy(light)
    return float(draw_between(among.range, among.range_source, seed))


def list_makers(front: Sequence[CellReading]) -> MeasuredValue:
    """Return the makers on a front, lightest cell first."""
    return MeasuredValue(', '.join(each.row.maker for each in front))


def quotient_errors(cells: Sequence[CellReading]) -> dict[str, MeasuredValue]:
    """Return the largest relative errors of the printed quotients."""
    worst = {}
    for which, reading in enumerate(POWERFILM_READINGS):
        rows = select_readings(cells, which)
        worst[f'mass_off_{reading}'] = MeasuredValue(
            max(abs(each.areal_mass / each.row.areal_mass.si - 1.0) for each in rows)
        )
        worst[f'time_off_{reading}'] = MeasuredValue(
            max(abs(each.charging_time_per_area / each.row.areal_charge.si - 1.0) for each in rows)
        )
    return worst


def data_sheet_times(cells: Sequence[CellReading]) -> dict[str, MeasuredValue]:
    """Return the charging times by short-circuit currents, scaled to ANYSOLAR's."""
    return {
        f'sheet_{each.cell.name}': MeasuredValue(datasheet_charging_time(each, cells))
        for each in cells
        if each.cell.name not in ('anysolar', 'dracula')  # anysolar is the reference
    }


def compute_array_power(table: CellTable, energy: EnergyBlock) -> dict[str, MeasuredValue]:
    """Return the net power of each array in stand-by and while transmitting, by light."""
    values: dict[str, MeasuredValue] = {}
    for net in list_printed_powers(table, energy):
        values |= label_net_powers(net)
    led, sun = (luminous_efficacy(name) for name in table.lights)
    light = table.arrays.illuminance.si
    # The paper's array of two ANYSOLAR panels in series
    panel = HarvestCurve.of_cells('anysolar', 2, 1)
    for task, load in zip(('standby', 'transmitting'), compute_ground_loads(energy), strict=True):
        even = break_even_illuminance(
            panel, ChargerModel.from_energy(energy), LAMPS['white LED'], load
        )
        values[f'light_for_{task}'] = MeasuredValue(even / light)
    # Radiant power of sunlight relative to LED light at the same illuminance
    return {**values, 'sun_by_led': MeasuredValue(led / sun)}


def label_net_powers(net: NetPower) -> dict[str, MeasuredValue]:
    """Return the net powers as named values."""
    name = f'{net.array.cell.name}_{CELL_LIGHTS[net.light]}'
    return {
        f'{name}_standby': MeasuredValue(net.standby),
        f'{name}_transmitting': MeasuredValue(net.transmitting),
    }
