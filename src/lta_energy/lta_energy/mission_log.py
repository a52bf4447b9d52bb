"""Record flights, charge and energy totals of a mission over days."""

from dataclasses import dataclass, field
from typing import final, NamedTuple

from lta_energy.circuit import EnergyTotals, NOTHING

# AWAY: landed elsewhere and waiting for pickup; OUT: on the perch with an empty cell
PERCHED, ASLEEP, ALOFT, AWAY, OUT = range(5)


class MissionFlight(NamedTuple):
    """Log entry of one flight."""

    start: float  # since the first midnight [s]
    duration: float  # time in the air [s]
    visits: int  # number of beacons of the round that were reached
    path: float  # horizontal length [m]
    spent: EnergyTotals
    # True state of charge [1]
    before: float
    after: float
    told: float  # estimated state of charge after the flight [1]
    lowest: float  # minimum voltage [V]
    # 'home', or how the flight failed: 'empty', 'away' (landed elsewhere at the reserve), 'lost'
    # (did not find the next beacon in time), 'escaped', 'stopped'
    ending: str


@final
@dataclass(slots=True)
class MissionLog:
    """Log of a mission."""

    flights: list[MissionFlight] = field(default_factory=list)
    time: list[float] = field(default_factory=list)  # sample times, about one per minute [s]
    # True state of charge, its estimate and the estimate's standard deviation [1]
    charge: list[float] = field(default_factory=list)
    told: list[float] = field(default_factory=list)
    deviation: list[float] = field(default_factory=list)
    state: list[int] = field(default_factory=list)  # `PERCHED`, `ASLEEP`, `ALOFT`, `AWAY` or `OUT`
    # Mean powers since the sample before; times the time between, they add up to `spent` [W]
    harvested: list[float] = field(default_factory=list)
    consumed: list[float] = field(default_factory=list)
    lost: list[float] = field(default_factory=list)
    spent: EnergyTotals = NOTHING  # energy totals, flights included [J]
    # Energy stored in the cell at start and end [J]
    begun: float = 0.0
    ended: float = 0.0
    outages: int = 0  # number of times that the cell ran empty on the perch
    dark: int = 0  # number of flights that ended without light on the panel

    @property
    def imbalance(self) -> float:
        """Residual of the energy balance, relative to the harvested or consumed energy. [1]"""
        spent = self.spent
        rest = spent.harvested - spent.consumed - spent.lost - (self.ended - self.begun)
        # The bound [J] avoids 0 / 0 in a mission without light and loads
        return rest / max(spent.harvested, spent.consumed, 1e-9)

    @property
    def failure_count(self) -> int:
        """Number of flights that failed or came home in the dark, plus outages on the perch."""
        return sum(each.ending != 'home' for each in self.flights) + self.dark + self.outages
