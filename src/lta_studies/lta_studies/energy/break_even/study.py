"""Compute the break-even map of a vehicle with its own array and with others."""

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
from lta_model.electrical.charger import ChargerModel
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.report import Report
from lta_report.request import Names, option, ReportRequest, StudyRun
import numpy as np

OWN: Final = 'as it is'
PAPER_BUDGET: Final = 48.8  # g: the seed paper's array of two ANYSOLAR panels
POINTS: Final = 61  # of a curve from 300 lx to 100 klx
HOVERING, FLYING = 1.333, 1.533  # W: seed paper, 1523 to 1544 mW for navigation


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
        from lta_studies.energy.break_even.report import build_report

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


@final
@dataclass(frozen=True, slots=True)
class BreakEvenMap:
    """Break-even map of a vehicle."""

    vehicle: str  # name of the vehicle
    charger: ChargerModel
    loads: Mapping[str, float]  # power of each task [W]
    arrays: Sequence[CandidateArray]  # arrays; the vehicle's own comes first

    def break_even_lux(self, array: CandidateArray, lamp: str, load: float) -> float:
        """Return the illuminance at which the charger output equals the load. [lx]"""
        return break_even_illuminance(array.harvest, self.charger, LAMPS[lamp], load)

    def sample_charger_output(
        self, array: CandidateArray, lamp: str
    ) -> tuple[list[float], list[float]]:
        """Return illuminances [lx] and the charger output there [W]."""
        lux = np.geomspace(LOWEST_ILLUMINANCE, HIGHEST_ILLUMINANCE, POINTS).tolist()
        return lux, [
            charging_power(array.harvest, self.charger, LAMPS[lamp], each) for each in lux
        ]

    def to_json(self) -> dict[str, object]:
        """Convert the map to JSON; null where 100 klx do not suffice."""
        thresholds = {
            f'{array.count} x {array.name}': {
                lamp: {
                    task: None
                    if (lux := self.break_even_lux(array, lamp, load)) > HIGHEST_ILLUMINANCE
                    else lux
                    for task, load in self.loads.items()
                }
                for lamp in LAMPS
            }
            for array in self.arrays
        }
        return {'vehicle': self.vehicle, 'loads': dict(self.loads), 'break_even_lux': thresholds}


def list_task_loads(vehicle: Vehicle) -> dict[str, float]:
    """Return the power of the tasks of a vehicle. [W]"""
    loads = vehicle.loads
    return {
        'idle': loads.idle,
        'transmitting': loads.idle + loads.transmitting,
        'hovering (paper)': HOVERING,
        'flying (paper)': FLYING,
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
    arrays = [CandidateArray(f'{own.cell_file.name} ({OWN})', count, mass, harvest)]
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


def format_klux(lux: float) -> str:
    """Format an illuminance [lx] in klx, without the unit, or 'never'."""
    return 'never' if lux > HIGHEST_ILLUMINANCE else f'{lux / 1e3:.1f}'
