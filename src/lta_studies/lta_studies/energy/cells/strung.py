"""Arrays of cells: what they weigh, and what reaches a drone's cell and loads in some light."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import final

from lta_config.schema.cell_file import CellFile, load_cell_file
from lta_config.schema.cell_table import Built, CellTable
from lta_config.schema.vehicle_energy import Energy
from lta_model.electrical.loads import demand, Loads
from lta_model.electrical.panel import max_power, Panel
from lta_model.electrical.power_path import Charger, output

LOWEST = 4.95  # V at the input of the LT3652 on the seed paper's charger (its data sheet)


@final
@dataclass(frozen=True, slots=True)
class Strung:
    """So many strings of so many panels."""

    cell: CellFile
    series: int
    parallel: int

    @property
    def count(self) -> int:
        """How many panels there are."""
        return self.series * self.parallel

    @property
    def mass(self) -> float:
        """Of the panels, without wiring. [kg]."""
        return self.count * self.cell.mass.si

    @property
    def area(self) -> float:
        """Of the panels. [m2]."""
        return self.count * self.cell.area

    def gives(self, irradiance: float) -> float:
        """Return the largest power in some light [W/m2]. [W]"""
        return math.prod(
            max_power(Panel.wired(self.cell.name, self.series, self.parallel), irradiance)
        )


def within(cell: CellFile, budget: float) -> Strung | None:
    """
    Return the array of most panels within a mass [kg] that the charger can work with.

    Strings are as short as reach the charger's lowest voltage at the rated maximum, so that fewest
    panels are left over; None where not even one string is light enough.
    """
    series = math.ceil(LOWEST / cell.electrical.voltage.si)
    parallel = int(budget / cell.mass.si * (1.0 + 1e-9)) // series
    return Strung(cell, series, parallel) if parallel else None


@final
@dataclass(frozen=True, slots=True)
class Net:
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


def nets(strung: Strung, energy: Energy, table: CellTable) -> list[Net]:
    """Return the net power of an array on a vehicle, for each kind of light of a table."""
    charger = Charger.of(energy)
    idle, sending = loads(energy)
    found = []
    for light, efficacy in table.lights.items():
        irradiance = table.arrays.illuminance.si / efficacy.si
        harvest = strung.gives(irradiance)
        given = output(charger, harvest)
        found.append(Net(light, irradiance, harvest, given, given - idle, given - sending))
    return found


def loads(energy: Energy) -> tuple[float, float]:
    """Return what stand-by and transmitting take, motors off. [W]"""
    own = Loads.of(energy)
    return demand(own, (), transmitting=False), demand(own, (), transmitting=True)


def readings(built: Built) -> list[Strung]:
    """Return an array that was built, for each reading of its cells."""
    return [Strung(load_cell_file(name), built.series, built.parallel) for name in built.cells]


def agrees(net: Net, built: Built) -> bool:
    """Tell whether the net power has the signs that were printed."""
    signs = ['surplus' if power > 0.0 else 'deficit' for power in (net.standby, net.transmitting)]
    return signs == [built.standby, built.transmitting]


def all_built(table: CellTable) -> Mapping[str, Sequence[Strung]]:
    """Return the arrays that were built, by name: an array for each reading."""
    return {name: readings(built) for name, built in table.arrays.built.items()}
