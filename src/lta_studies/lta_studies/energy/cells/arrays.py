"""Arrays of cells: what they weigh, and what reaches a drone's cell and loads in some light."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_config.schema.cell_file import CellFile, load_cell_file
from lta_config.schema.cell_table import CellTable, PrintedArray
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_model.electrical.charger import charger_output, ChargerModel
from lta_model.electrical.loads import LoadModel, power_demand
from lta_model.electrical.panel import find_max_power, SolarArrayModel

LOWEST = 4.95  # V at the input of the LT3652 on the seed paper's charger (its data sheet)


@final
@dataclass(frozen=True, slots=True)
class CellArray:
    """So many strings of so many panels."""

    cell: CellFile
    series: int
    parallel: int

    @property
    def panel_count(self) -> int:
        """How many panels there are."""
        return self.series * self.parallel

    @property
    def mass(self) -> float:
        """Of the panels, without wiring. [kg]."""
        return self.panel_count * self.cell.mass.si

    @property
    def area(self) -> float:
        """Of the panels. [m2]."""
        return self.panel_count * self.cell.area

    def peak_power(self, irradiance: float) -> float:
        """Return the largest power in some light [W/m2]. [W]"""
        return math.prod(
            find_max_power(
                SolarArrayModel.from_cells(self.cell.name, self.series, self.parallel), irradiance
            )
        )


def find_largest_array(cell: CellFile, budget: float) -> CellArray | None:
    """
    Return the array of most panels within a mass [kg] that the charger can work with.

    Strings are as short as reach the charger's lowest voltage at the rated maximum, so that fewest
    panels are left over; None where not even one string is light enough.
    """
    series = math.ceil(LOWEST / cell.electrical.voltage.si)
    parallel = int(budget / cell.mass.si * (1.0 + 1e-9)) // series
    return CellArray(cell, series, parallel) if parallel else None


@final
@dataclass(frozen=True, slots=True)
class NetPower:
    """
    The net power of an array in some kind of light. [W]

    `standby` and `transmitting` are what is left after the loads, `given` what the charger gives.
    """

    light: str
    irradiance: float
    harvest: float
    given: float
    standby: float
    transmitting: float


def compute_net_powers(array: CellArray, energy: EnergyBlock, table: CellTable) -> list[NetPower]:
    """Return the net power of an array on a vehicle, for each kind of light of a table."""
    charger = ChargerModel.from_energy(energy)
    idle, sending = compute_ground_loads(energy)
    found = []
    for light, efficacy in table.lights.items():
        irradiance = table.arrays.illuminance.si / efficacy.si
        harvest = array.peak_power(irradiance)
        given = charger_output(charger, harvest)
        found.append(NetPower(light, irradiance, harvest, given, given - idle, given - sending))
    return found


def compute_ground_loads(energy: EnergyBlock) -> tuple[float, float]:
    """Return what stand-by and transmitting take, motors off. [W]"""
    own = LoadModel.from_energy(energy)
    return power_demand(own, (), transmitting=False), power_demand(own, (), transmitting=True)


def build_array_readings(built: PrintedArray) -> list[CellArray]:
    """Return an array that was built, for each reading of its cells."""
    return [CellArray(load_cell_file(name), built.series, built.parallel) for name in built.cells]


def has_printed_signs(net: NetPower, built: PrintedArray) -> bool:
    """Tell whether the net power has the signs that were printed."""
    signs = ['surplus' if power > 0.0 else 'deficit' for power in (net.standby, net.transmitting)]
    return signs == [built.standby, built.transmitting]


def build_all_arrays(table: CellTable) -> Mapping[str, Sequence[CellArray]]:
    """Return the arrays that were built, by name: an array for each reading."""
    return {name: build_array_readings(built) for name, built in table.arrays.built.items()}
