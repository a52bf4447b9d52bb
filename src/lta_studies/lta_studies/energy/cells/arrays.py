# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Rank solar cells, and compute mass and net power of arrays of them in a given light.

The time to charge a given capacitor falls with the area of a cell. Time *per* area, the criterion
of the seed paper, therefore rewards a large cell twice. Time *times* area does not depend on the
size.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Annotated, final

from lta_config.errors import BadInput
from lta_config.schema.cell_file import (
    BuiltArray,
    CellFile,
    CellTable,
    CellTableRow,
    load_cell_file,
    load_cell_table,
)
from lta_config.schema.spectrum_file import luminous_efficacy
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_model.electrical.loads import LoadModel, power_demand
from lta_model.electrical.mppt_charger import charger_output, ChargerModel
from lta_model.electrical.panel import cell_spectral_factor, find_max_power_point, SolarArrayModel
from lta_report.report import Report
from lta_report.request import argument, Mass, option, ReportRequest, StudyRun
from pydantic import Field


@final
@dataclass(frozen=True, slots=True)
class CellReading:
    """One reading of one row."""

    row: CellTableRow  # row as printed
    cell: CellFile  # panel that the row is read as
    readings: int  # number of possible readings of the row

    @property
    def title(self) -> str:
        """Label in tables and plots."""
        size = f', {1e4 * self.cell.area:.1f} cm²' if self.readings > 1 else ''
        return f'{self.row.maker}{size}'

    @property
    def areal_mass(self) -> float:
        """Mass per area [kg/m2]."""
        return self.cell.mass.si / self.cell.area

    @property
    def charging_time_per_area(self) -> float:
        """Charging time per area, the paper's criterion [s/m2]."""
        return self.row.charge.si / self.cell.area

    @property
    def charging_time_times_area(self) -> float:
        """Charging time times area, the fair criterion [s m2]."""
        return self.row.charge.si * self.cell.area

    @property
    def charging_time_times_mass(self) -> float:
        """Charging time times the printed mass [s kg]."""
        return self.row.charge.si * self.row.mass.si


Criterion = Callable[[CellReading], float]


def list_readings(table: CellTable) -> list[CellReading]:
    """Return every reading of every row."""
    return [
        CellReading(row, load_cell_file(name), len(row.cells))
        for row in table.rows.values()
        for name in row.cells
    ]


def select_readings(entries: Sequence[CellReading], which: int) -> list[CellReading]:
    """Return one entry per row; `which` selects among several readings."""
    return [each for each in entries if each.cell.name == each.row.cells[which % each.readings]]


def find_pareto_front(entries: Sequence[CellReading], criterion: Criterion) -> list[CellReading]:
    """Return the Pareto front in mass per area and a criterion, lightest first."""
    best, front = float('inf'), []
    # From light to heavy: an entry is on the front if it improves on all lighter ones.
    for each in sorted(entries, key=lambda entry: (entry.areal_mass, criterion(entry))):
        if criterion(each) < best:
            best = criterion(each)
            front.append(each)
    return front


LOWEST_CHARGER_INPUT = 4.95  # V, minimum input of the seed paper's charger LT3652 (data sheet)


@final
@dataclass(frozen=True, slots=True)
class CellArray:
    """An array of parallel strings of panels in series."""

    cell: CellFile
    series: int
    parallel: int
    printed: BuiltArray | None = None  # what the paper prints of it

    @property
    def panel_count(self) -> int:
        """Return the number of panels."""
        return self.series * self.parallel

    @property
    def mass(self) -> float:
        """Mass of the panels, without wiring [kg]."""
        return self.panel_count * self.cell.mass.si

    @property
    def area(self) -> float:
        """Area of the panels [m2]."""
        return self.panel_count * self.cell.area

    def peak_power(self, irradiance: float) -> float:
        """Return the maximum power [W] at an irradiance of sunlight [W/m2]."""
        return math.prod(
            find_max_power_point(
                SolarArrayModel.from_cell_file(self.cell, self.series, self.parallel), irradiance
            )
        )


def find_largest_array(cell: CellFile, budget: float) -> CellArray | None:
    """
    Return the array with the most panels within a mass [kg] that suits the charger.

    Strings are just long enough to reach the charger's minimum input voltage at the maximum power
    point. None if even one string is too heavy.
    """
    # Enough panels in series for the minimum input voltage of the charger
    series = math.ceil(LOWEST_CHARGER_INPUT / cell.electrical.voltage.si)
    # 1e-9 keeps a budget of exactly n panels at n despite rounding.
    parallel = int(budget / cell.mass.si * (1.0 + 1e-9)) // series
    return CellArray(cell, series, parallel) if parallel else None


@final
@dataclass(frozen=True, slots=True)
class NetPower:
    """
    The net power of an array in some kind of light [W].

    `charger` is the charger output; `standby` and `transmitting` are that minus the loads.
    """

    array: CellArray
    light: str
    irradiance: float
    harvest: float
    charger: float
    standby: float
    transmitting: float

    @property
    def has_printed_signs(self) -> bool:
        """Whether the net power of an array of the paper has the printed signs."""
        built, powers = self.array.printed, (self.standby, self.transmitting)
        signs = ['surplus' if power > 0.0 else 'deficit' for power in powers]
        return built is not None and signs == [built.standby, built.transmitting]


def compute_net_powers(
    array: CellArray,
    energy: EnergyBlock,
    table: CellTable,
    efficacies: Mapping[str, float] = {},
) -> list[NetPower]:
    """
    Return the net power of an array on a vehicle for each light of a table.

    `efficacies`: luminous efficacy of lights other than those of the shipped spectra. [lm/W]
    """
    charger = ChargerModel.from_energy(energy)
    # Motors off: the array charges on the ground.
    idle, sending = compute_ground_loads(energy)
    powers = []
    for light in table.lights:
        own = luminous_efficacy(light)
        # lx / (lm/W) = W/m2
        irradiance = table.arrays.illuminance.si / efficacies.get(light, own)
        factor = cell_spectral_factor(array.cell.name, own)
        harvest = array.peak_power(factor * irradiance)
        charged = charger_output(charger, harvest)
        powers.append(
            NetPower(array, light, irradiance, harvest, charged, charged - idle, charged - sending)
        )
    return powers


def compute_ground_loads(energy: EnergyBlock) -> tuple[float, float]:
    """Return the power in stand-by and while transmitting, motors off [W]."""
    own = LoadModel.from_energy(energy)
    return power_demand(own, (), transmitting=False), power_demand(own, (), transmitting=True)


def build_printed_arrays(built: BuiltArray) -> list[CellArray]:
    """Return a printed array for each reading of its cells."""
    return [
        CellArray(load_cell_file(name), built.series, built.parallel, built)
        for name in built.cells
    ]


def build_all_arrays(table: CellTable) -> Mapping[str, Sequence[CellArray]]:
    """Return the printed arrays by name, one for each reading."""
    return {name: build_printed_arrays(built) for name, built in table.arrays.built.items()}


@final
class CellsRequest(ReportRequest, command='cells'):
    """
    Compare solar cells by charging time, and the arrays that fit into a weight budget.

    Ranks cells by the paper's figure (charging time of a capacitor divided by area) and by a
    fairer one (time multiplied by area). Reports the surplus of the paper's arrays in stand-by and
    while transmitting, under white LED light and sunlight of equal illuminance, and the largest
    array of each cell within the budget. Panels are files in config/cells, tables are in
    config/cell_tables.

    The results are a page and cells.json (SI units).

    Exit status 0: done. 2: bad input.

    Example: lta cells --budget "50 g"
    """

    table: str = argument(
        'Table of solar cells: a name in config/cell_tables, or a file.', default='seed_paper'
    )
    # 100 kg: far above any vehicle here, but it catches a wrong unit
    budget: Annotated[Mass, Field(gt=0.0, le=100.0)] = option(
        'Maximum mass of a solar array, such as "50 g".', default='50 g'
    )
    vehicle: str = option(
        'Vehicle whose solar charger and electrical loads are used.', default='gtmab',
        complete='vehicle',
    )  # fmt: skip

    def run(self, run: StudyRun) -> Report:
        """Return the report of a table."""
        from lta_studies.energy.cells.report import build_report

        energy = load_vehicle_file(self.vehicle).energy
        # Without a charger, the surplus of an array is undefined
        if energy.charger is None:
            raise BadInput(
                f"Vehicle '{self.vehicle}' has no charger for solar panels; choose another "
                '--vehicle.'
            )
        return build_report(load_cell_table(self.table), energy, self.budget)
