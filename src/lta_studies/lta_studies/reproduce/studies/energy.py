# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Study energy: power budget, hovering for 450 s on one cell, and charging ratios."""

from collections.abc import Mapping
from functools import partial
import math
from typing import Final

from lta_config.command_line import format_lta_command
from lta_config.schema.spectrum_file import luminous_efficacy
from lta_energy.harvest import charging_power, HarvestCurve, LAMPS, LightSource, WHITE_LED
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
from lta_model.electrical.panel import cell_spectral_factor, SolarArrayModel
from lta_model.vehicle import load_vehicle, Vehicle
from lta_studies.energy import paper
from lta_studies.energy.budget.hover import HoverComparison, HoverStudy
from lta_studies.energy.budget.report import (
    build_cause_table,
    build_task_table,
    draw_task_power,
    draw_voltage,
    TASK_CAPTION,
    VOLTAGE_CAPTION,
)
from lta_studies.energy.budget.run import (
    BUDGET_SCENE,
    BUDGET_STRATEGIES,
    measure_budget,
    PowerBudget,
    TaskPower,
)
from lta_studies.reproduce.flights import fly_draws
from lta_studies.reproduce.studies.cells import draw_cell, draw_efficacy
from lta_studies.reproduce.study_result import (
    collect_draws,
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
    to_values,
)

ENERGY_VEHICLE, STANDARD_VEHICLE = 'gtmab', 'multirotor'
CHARGING_LUX: Final = 80e3  # seed paper
HOUR: Final = 3600.0  # s
PRINTED_POWERS: Final = {'paper_fly': sum(paper.NAVIGATION) / 2.0, 'paper_hover': paper.HOVER}  # W
LIGHT_NAMES: Final = {'white LED': 'led', 'flickering LED': 'flicker', 'sun': 'sun'}
TASK: Final = {
    'take-off': 'take_off', 'hovering': 'hover', 'flying at 0.5 m/s': 'fly',
    'navigating, BAG': 'bag', 'navigating, DES': 'des', 'navigating, DGA': 'dga',
}  # fmt: skip


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Measure power budget, cell voltage and charging."""
    budget = measure_budget(ENERGY_VEHICLE, STANDARD_VEHICLE, request.seeds)
    values = {**measure_task_power(budget, request.seeds), **measure_causes(budget)}
    body = load_vehicle(ENERGY_VEHICLE)
    harvest = HarvestCurve.of_energy(body.file.energy)
    own = {
        'fly': budget.tasks['navigating, BAG'].power,
        'hover': budget.tasks['hovering'].power,
    }
    values |= to_values(measure_charging(body, harvest, {**PRINTED_POWERS, **own}))
    draws = {**draw_navigation(request), **collect_draws(request, partial(measure_draw, request))}
    pictures = [
        StudyPicture('tasks', 'Power by task', TASK_CAPTION, draw_task_power(budget),
                     format_lta_command('energy', 'budget', '--seeds', str(request.seeds)))
    ]  # fmt: skip
    if request.quick:
        return RowStudyResult(
            values, pictures, [build_task_table(budget), build_cause_table(budget)], draws
        )
    hover = HoverStudy(ENERGY_VEHICLE, STANDARD_VEHICLE)
    comparison = hover.compare([hover.fly(drone) for drone in range(2)])
    values |= measure_hover(comparison)
    pictures.append(
        StudyPicture('voltage', 'Voltage of the cell while hovering', VOLTAGE_CAPTION,
                     draw_voltage(comparison), format_lta_command('energy', 'budget'))
    )  # fmt: skip
    tables = [build_task_table(budget), build_cause_table(budget)]
    return RowStudyResult(values, pictures, tables, draws)


def draw_navigation(request: RowStudyRequest) -> dict[str, list[float | str]]:
    """Return the power of navigating by each strategy, one flight in every draw [W]."""
    rows = fly_draws('light_indoors', request, strategies=BUDGET_STRATEGIES)
    powers: dict[str, list[float | str]] = {
        name: [float(row.figures.get('power') or math.nan) for (row,) in results]
        for name, results in rows.items()
    }
    together = zip(*powers.values(), strict=True)
    powers['strategies_apart'] = [max(each) - min(each) for each in together]
    return powers


def measure_draw(request: RowStudyRequest, seed: int) -> dict[str, float]:
    """Return what charging gives in a draw, by the powers that the paper prints."""
    spec = load_spec(ENERGY_VEHICLE, BUDGET_SCENE, 'bag', '').with_values(
        request.draw_changes(seed)
    )
    body = build_vehicle_scenario_stack(spec)[0]
    array = body.file.energy.array
    assert array is not None
    cell = array.cell_file.name
    panel = SolarArrayModel.from_cell_file(draw_cell(cell, seed), array.series, array.parallel)
    harvest = HarvestCurve(panel, cell_spectral_factor(cell, luminous_efficacy(WHITE_LED)))
    lamps = {
        name: lamp._replace(
            efficacy_ratio=draw_efficacy(lamp.spectrum, seed) / luminous_efficacy(lamp.spectrum)
        )
        for name, lamp in LAMPS.items()
    }
    return measure_charging(body, harvest, PRINTED_POWERS, lamps)


def measure_task_power(power_budget: PowerBudget, seeds: int) -> dict[str, MeasuredValue]:
    """Return the power of every task, and ratios of them."""
    values = {name: task_power(power_budget.tasks[task], seeds) for task, name in TASK.items()}
    hover = power_budget.tasks['hovering'].power
    return {
        **values,
        'standard': task_power(power_budget.hover, seeds),
        'share': MeasuredValue(hover / power_budget.hover.power, seeds=seeds),
        'fly_share': MeasuredValue(
            power_budget.tasks['flying at 0.5 m/s'].power / power_budget.hover.power
        ),
        'paper_share': MeasuredValue(paper.HOVER / power_budget.hover.power),
        'strategies_apart': MeasuredValue(
            max(power_budget.tasks[f'navigating, {each}'].power for each in ('BAG', 'DES', 'DGA'))
            - min(
                power_budget.tasks[f'navigating, {each}'].power for each in ('BAG', 'DES', 'DGA')
            )
        ),
    }


def task_power(task: TaskPower, seeds: int) -> MeasuredValue:
    """Return the power of a task with the spread of single flights [W]."""
    if seeds == 1:
        return MeasuredValue(task.power)
    return MeasuredValue(task.power, task.power - task.off, task.power + task.off, seeds)


def measure_causes(power_budget: PowerBudget) -> dict[str, MeasuredValue]:
    """Return candidate causes of the paper's hover power."""
    cause = power_budget.causes
    return {
        'ideal_hover': MeasuredValue(cause.least),
        'heavy': MeasuredValue(cause.heaviness),
        'draught': MeasuredValue(cause.wind),
        'worse_rotors': MeasuredValue(cause.factor),
    }


def measure_hover(comparison: HoverComparison) -> dict[str, MeasuredValue]:
    """Return the voltage drops on identical cells."""
    first, second = comparison.first.trace, comparison.second.trace
    lasted = comparison.seconds if second.failed is None else second.failed
    # Compare the drops over the time in which both drones flew.
    while_both = float(first.voltage[0] - first.voltage[first.time <= lasted][-1])
    return {
        'drop': MeasuredValue(first.voltage_drop),
        'drop_share': MeasuredValue(while_both / second.voltage_drop),
        'standard_lasts': MeasuredValue(lasted),
        'charge_used': MeasuredValue(1.0 - float(first.charge[-1])),
    }


def measure_charging(
    body: Vehicle,
    harvest: HarvestCurve,
    powers: Mapping[str, float],
    lamps: Mapping[str, LightSource] = LAMPS,
) -> dict[str, float]:
    """Return the net charging power and charging ratios at 80 klux, by kind of light."""
    net = {
        LIGHT_NAMES[name]: charging_power(harvest, body.charger, lamp, CHARGING_LUX)
        - body.loads.idle
        for name, lamp in lamps.items()
    }
    return {f'net_{name}': each for name, each in net.items()} | charging_ratios(net, powers)


def charging_ratios(net: Mapping[str, float], powers: Mapping[str, float]) -> dict[str, float]:
    """Return the ratios of charging to flight time, and seconds of flight per charged hour."""
    values = {}
    for light, watts in net.items():
        for task, power in powers.items():
            # Light that does not cover the idle power never charges the cell.
            ratio = power / watts if watts > 0.0 else math.inf
            values[f'ratio_{task}_{light}'] = ratio
        # One third of flying, two thirds of hovering.
        mixed = (powers['paper_fly'] + 2.0 * powers['paper_hover']) / 3.0
        values[f'minutes_{light}'] = HOUR * watts / mixed
    return values
