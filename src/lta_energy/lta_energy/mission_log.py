"""Record flights, charge and energy balance of a mission over days."""

from dataclasses import dataclass, field
from typing import final, NamedTuple

from lta_energy.circuit import EnergyTotals, NOTHING

PERCHED, ASLEEP, ALOFT, AWAY, OUT = range(5)


class MissionFlight(NamedTuple):
    """
    One flight.

    Attributes
    ----------
    start, duration : float
        Since the first midnight, and in the air. [s]
    visits : int
        Beacons of the round that were reached.
    path : float
        Horizontal. [m]
    spent : Spent
        Energy.
    before, after : float
        True state of charge.
    told : float
        The drone's own, after it.
    lowest : float
        Voltage. [V]
    ending : str
        'home', or how it failed: 'empty', 'away' (landed elsewhere at the reserve), 'lost' (did
        not find the next beacon in time), 'escaped', 'stopped'.

    """

    start: float
    duration: float
    visits: int
    path: float
    spent: EnergyTotals
    before: float
    after: float
    told: float
    lowest: float
    ending: str


@final
@dataclass(slots=True)
class MissionLog:
    """
    What has happened.

    Attributes
    ----------
    flights : list of Flight
        One after the other.
    time, charge, told, deviation, state : list
        Minute by minute: s, true and told state of charge, its deviation, and what the drone does.
    spent : Spent
        Energy, flights included. [J]
    begun, ended : float
        What the cell held. [J]
    outages : int
        How often the cell was empty on the perch.
    dark : int
        Flights that ended without light on the panel.

    """

    flights: list[MissionFlight] = field(default_factory=list)
    time: list[float] = field(default_factory=list)
    charge: list[float] = field(default_factory=list)
    told: list[float] = field(default_factory=list)
    deviation: list[float] = field(default_factory=list)
    state: list[int] = field(default_factory=list)
    spent: EnergyTotals = NOTHING
    begun: float = 0.0
    ended: float = 0.0
    outages: int = 0
    dark: int = 0

    @property
    def imbalance(self) -> float:
        """What the books do not account for, by what was harvested or consumed. [1]"""
        spent = self.spent
        rest = spent.harvested - spent.consumed - spent.lost - (self.ended - self.begun)
        return rest / max(spent.harvested, spent.consumed, 1e-9)

    @property
    def failure_count(self) -> int:
        """Flights that did not come home or came home in the dark, and outages on the perch."""
        return sum(each.ending != 'home' for each in self.flights) + self.dark + self.outages
