"""One turn of the drone's meters, and where it then took itself to be."""

from dataclasses import dataclass
import math
from typing import final


@final
@dataclass(frozen=True, slots=True)
class Whereabouts:
    """
    Where the drone is by dead reckoning, and how fast it flies.

    Attributes
    ----------
    distance : float
        Horizontal, from where it started. [m]
    speed : float
        Horizontal, through the air: the ground is not observable. [m/s]

    """

    distance: float
    speed: float


@final
@dataclass(frozen=True, slots=True)
class Reading:
    """
    One turn of the meters; NaN is what is not measured.

    Attributes
    ----------
    stamp_ns : int
        When. [ns]
    voltage, current : float
        Cell; a positive current charges. [V, A]
    panel_voltage, panel_current : float
        Harvesting branch; a positive current harvests. [V, A]
    illuminance : float
        Light at the panel. [lx]
    where : Whereabouts or None
        None while the drone does not know.

    """

    stamp_ns: int
    voltage: float
    current: float
    panel_voltage: float = math.nan
    panel_current: float = math.nan
    illuminance: float = math.nan
    where: Whereabouts | None = None

    @property
    def usable(self) -> bool:
        """Whether the cell's voltage and current are numbers."""
        return math.isfinite(self.voltage) and math.isfinite(self.current)

    @property
    def harvest(self) -> float:
        """Power of the panel. [W]"""
        return self.panel_voltage * self.panel_current

    @property
    def income(self) -> float:
        """Power of the panel as the books take it: 0 where it is not measured. [W]"""
        return self.harvest if math.isfinite(self.harvest) else 0.0

    @property
    def power(self) -> float:
        """Power into the cell at its terminals. [W]"""
        return self.voltage * self.current
