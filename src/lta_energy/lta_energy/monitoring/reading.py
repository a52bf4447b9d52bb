"""Define one reading of the power meters, with the estimated position."""

from dataclasses import dataclass
import math
from typing import Final, final

# What no meter of a small cell reads: one believed reading of 1e30 A spoils the filter for good.
MOST_VOLTS: Final = 100.0
MOST_AMPERES: Final = 100.0


@final
@dataclass(frozen=True, slots=True)
class TravelState:
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
class MeterReading:
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
    where: TravelState | None = None

    @property
    def is_usable(self) -> bool:
        """Whether the cell's voltage and current are numbers that a meter can read."""
        return abs(self.voltage) <= MOST_VOLTS and abs(self.current) <= MOST_AMPERES

    @property
    def panel_power(self) -> float:
        """Power of the panel. [W]"""
        return self.panel_voltage * self.panel_current

    @property
    def plausible_panel_power(self) -> float:
        """Power of the panel as the books take it: 0 where no meter can have read it. [W]"""
        known = abs(self.panel_voltage) <= MOST_VOLTS and abs(self.panel_current) <= MOST_AMPERES
        return self.panel_power if known else 0.0

    @property
    def cell_power(self) -> float:
        """Power into the cell at its terminals. [W]"""
        return self.voltage * self.current
