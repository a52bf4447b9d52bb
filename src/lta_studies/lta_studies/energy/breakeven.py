# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compute the light that powers each task of a vehicle, by lamp and solar array."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_config.errors import BadInput
from lta_config.schema.cell_file import load_cell_file
from lta_energy.harvest import (
    break_even_illuminance,
    charging_power,
    HarvestCurve,
    HIGHEST_ILLUMINANCE,
    LAMPS,
    LOWEST_ILLUMINANCE,
)
from lta_model.electrical.mppt_charger import ChargerModel
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.charts import ChartAxis, Curve, draw_curves, item_colour, Level
from lta_report.formatting import Tile
from lta_report.report import Picture, Report, TextSection
from lta_report.request import Names, option, ReportRequest, StudyRun
from lta_report.result_table import build_table, Column
from lta_studies.energy import paper
import numpy as np
from plotly.graph_objects import Figure

OWN_ARRAY: Final = 'as it is'
PAPER_BUDGET: Final = 48.8  # g: the seed paper's array of two ANYSOLAR panels
CURVE_POINTS: Final = 61  # of a curve from 300 lx to 100 klx
PAPER_FLIGHT_POWER = 1.533  # W: seed paper, 1523 to 1544 mW for navigation
LAMP_WORDS: Final = (
    'steady white LED light',
    'flickering white LED light',
    'sunlight',
)  # of LAMPS
ILLUMINANCE_TICKS: Final = {
    300: '300 lx', 1e3: '1 klx', 3e3: '3 klx', 1e4: '10 klx', 3e4: '30 klx', 1e5: '100 klx',
}  # fmt: skip
BREAK_EVEN_ABOUT: Final = (
    'Power of the solar array and its charger, from 300 lx in a warehouse to full sun, '
    'compared with the power that each task needs.'
)
INCOME: Final = (
    "Charger output with the vehicle's own array, for each kind of light. Dotted: power "
    'that each task needs. In weak light the charger is off, because it would use more '
    'power than it delivers.'
)
BREAK_EVEN_NOTE: Final = (
    'Illuminance on the level panel at which the charger output equals the power of the '
    'task, in kilolux. For a beacon: illuminance while it is on.'
)
BREAK_EVEN_METHOD: Final = (
    'Each panel is a single-diode model, with one string per panel and cells warmed by the '
    'light. The charger is that of the vehicle file. An array has as many panels as the '
    'mass budget allows, at least one.',
    'Luminous efficacy and the response of each cell by the spectra of the lights: 326 lm/W for '
    'white LED light, 109 lm/W for sunlight.',
    'The powers for hovering and flying are those of the paper (Huang et al. 2025); '
    '"lta energy budget" computes them from simulated flights.',
)


@final
class BreakEvenRequest(ReportRequest, command='energy breakeven'):
    """
    Compute the break-even illuminance of a drone: idle, transmitting, hovering, flying.

    Covers 300 lx to 100 klx from a white LED, a flickering beacon and the sun; with the vehicle's
    own array and with arrays of other panels within a mass budget.

    Exit status 0: done. 2: bad input.

    Example: lta energy breakeven --cell kitronik --budget 60
    """

    vehicle: str = option(
        'Vehicle whose electrical loads, solar array and charger are used.', default='gtmab',
        complete='vehicle',
    )  # fmt: skip
    cell: Names = option(
        'Solar panel for an alternative array, name or file; repeat to compare several.',
        default=('powerfilm_large', 'anysolar', 'adafruit', 'dracula'),
    )
    budget: float = option(
        'Maximum mass of each alternative solar array in g.', default=PAPER_BUDGET, low=1.0,
        high=10_000.0,
    )  # fmt: skip

    def run(self, run: StudyRun) -> Report:
        """Return the report of the vehicle's own array and of others."""
        # g to kg
        arrays = compute_break_even_map(load_vehicle(self.vehicle), self.cell, 1e-3 * self.budget)
        return build_report(arrays)


@final
@dataclass(frozen=True, slots=True)
class CandidateArray:
    """An array: its cell, number of panels, mass [kg] and harvest."""

    name: str
    count: int
    mass: float
    harvest: HarvestCurve

    @property
    def title(self) -> str:
        """Return the number and name of its panels."""
        return f'{self.count} x {self.name}'


@final
@dataclass(frozen=True, slots=True)
class BreakEvenMap:
    """Break-even map of a vehicle."""

    vehicle: str  # name of the vehicle
    charger: ChargerModel
    loads: Mapping[str, float]  # power of each task [W]
    arrays: Sequence[CandidateArray]  # arrays; the vehicle's own comes first

    def break_even_lux(self, array: CandidateArray, lamp: str, load: float) -> float:
        """Return the illuminance at which the charger output equals the load [lx]."""
        return break_even_illuminance(array.harvest, self.charger, LAMPS[lamp], load)

    def sample_charger_output(
        self, array: CandidateArray, lamp: str
    ) -> tuple[list[float], list[float]]:
        """Return illuminances [lx] and the charger output there [W]."""
        lux = np.geomspace(LOWEST_ILLUMINANCE, HIGHEST_ILLUMINANCE, CURVE_POINTS).tolist()
        return lux, [
            charging_power(array.harvest, self.charger, LAMPS[lamp], each) for each in lux
        ]


def list_task_loads(vehicle: Vehicle) -> dict[str, float]:
    """Return the power of the tasks of a vehicle [W]."""
    loads = vehicle.loads
    return {
        'idle': loads.idle,
        'transmitting': loads.idle + loads.transmitting,
        'hovering (paper)': paper.HOVER,
        'flying (paper)': PAPER_FLIGHT_POWER,
    }


def compute_break_even_map(vehicle: Vehicle, cells: Sequence[str], budget: float) -> BreakEvenMap:
    """
    Compute the map of a vehicle.

    `vehicle`: provides loads, charger and its own array. `cells`: cells for alternative arrays.
    `budget`: mass limit of each array [kg]. Raise `BadInput` if the vehicle has no array, or one
    panel is heavier than the budget.
    """
    own = vehicle.file.energy.array
    if own is None:
        raise BadInput(
            f'{vehicle.file.name} has no solar array; choose a vehicle with a solar array.'
        )
    count = own.series * own.parallel
    mass = count * own.cell_file.mass.si
    harvest = HarvestCurve.of_energy(vehicle.file.energy)
    arrays = [CandidateArray(f'{own.cell_file.name} ({OWN_ARRAY})', count, mass, harvest)]
    for name in cells:
        each = load_cell_file(name).mass.si
        # As many whole panels as the mass budget allows
        number = int(budget / each)
        if number == 0:
            raise BadInput(
                f'One solar panel {name} weighs {1e3 * each:.1f} g, more than the mass --budget '
                f'of {1e3 * budget:g} g; choose another --cell, or raise --budget.'
            )
        # Strings of one panel, all in parallel
        harvest = HarvestCurve.of_cells(name, 1, number)
        arrays.append(CandidateArray(name, number, number * each, harvest))
    return BreakEvenMap(vehicle.file.name, vehicle.charger, list_task_loads(vehicle), arrays)


def build_report(result: BreakEvenMap) -> Report:
    """Return the report of a break-even map."""
    own, pairs = result.arrays[0], [(array, lamp) for array in result.arrays for lamp in LAMPS]

    def lux(array: CandidateArray, lamp: str) -> dict[str, float | None]:
        """Return the illuminance for each task, None where 100 klx do not suffice [lx]."""
        needed = {
            task: result.break_even_lux(array, lamp, load) for task, load in result.loads.items()
        }
        return {task: v if v <= HIGHEST_ILLUMINANCE else None for task, v in needed.items()}

    def task_column(task: str, load: float) -> Column[tuple[CandidateArray, str]]:
        """Return the column of a task."""
        title = f'{task}, {1e3 * load:.0f} mW'
        return Column('', title, of=lambda pair: format_klux(lux(*pair)[task]))

    columns: list[Column[tuple[CandidateArray, str]]] = [
        Column('', 'array', of=lambda pair: pair[0].title),
        Column('', 'g', digits=0, of=lambda pair: pair[0].mass, factor=1e3),
        Column('', 'light', of=lambda pair: pair[1]),
        *(task_column(task, load) for task, load in result.loads.items()),
    ]
    idle = [
        f'{format_klux(each)} klx of {name}'
        for lamp, name in zip(LAMPS, LAMP_WORDS, strict=True)
        if (each := lux(own, lamp)['idle']) is not None
    ]
    return Report(
        command='energy breakeven',
        subject=result.vehicle,
        headline=f'{result.vehicle} can idle indefinitely at {", or at ".join(idle)}.' if idle
        else f'{result.vehicle} cannot idle indefinitely at any illuminance.',
        introduction=BREAK_EVEN_ABOUT,
        tiles=[
            Tile(task, format_klux(lux(own, 'sun')[task]), 'klx',
                 f'of sunlight give the {1e3 * load:.0f} mW that it needs')
            for task, load in result.loads.items()
        ],
        blocks=(
            Picture('income', 'Power from the light', INCOME, plot_charger_output(result)),
            build_table('Break-even [klx]', columns, pairs, BREAK_EVEN_NOTE),
            TextSection('Meaning and method', BREAK_EVEN_METHOD),
        ),
        data={
            'vehicle': result.vehicle,
            'loads': dict(result.loads),
            'break_even_lux': {
                array.title: {lamp: lux(array, lamp) for lamp in LAMPS} for array in result.arrays
            },
        },
        facts={'vehicle': result.vehicle},
    )  # fmt: skip


def plot_charger_output(result: BreakEvenMap) -> Figure:
    """Plot the charger output against illuminance, with the power of the tasks."""
    curves = []
    for k, lamp in enumerate(LAMPS):
        lux, watts = result.sample_charger_output(result.arrays[0], lamp)
        # A logarithmic axis cannot show zero
        milliwatts = [1e3 * each if each > 0.0 else None for each in watts]
        curves.append(Curve(lamp, lux, milliwatts, item_colour(k), '%{y:.0f} mW'))
    levels = [
        # The lower of two close lines is labelled below, the upper one above
        Level(1e3 * load, task, right=True, below=task.startswith(('idle', 'hovering')))
        for task, load in result.loads.items()
    ]
    ticks = ChartAxis(
        'illuminance on the level panel', log=True, ticks=list(ILLUMINANCE_TICKS),
        words=list(ILLUMINANCE_TICKS.values()),
    )  # fmt: skip
    return draw_curves(curves, ticks, ChartAxis('charger output [mW]', log=True), levels=levels)


def format_klux(lux: float | None) -> str:
    """Format an illuminance [lx] in klx, without the unit, or 'never'."""
    return 'never' if lux is None else f'{lux / 1e3:.1f}'
