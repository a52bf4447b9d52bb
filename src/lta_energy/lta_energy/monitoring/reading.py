"""Define one reading of the power meters, with the estimated position."""

from dataclasses import dataclass
import math
from typing import Final, final

# Beyond the range of any meter of a small cell; one reading of 1e30 A would ruin the filter.
MOST_VOLTS: Final = 100.0
MOST_AMPERES: Final = 100.0


@final
@dataclass(frozen=True, slots=True)
class TravelState:
    """Dead-reckoned distance and speed of the drone."""

    distance: float  # horizontal distance from the start [m]
    speed: float  # horizontal airspeed; ground speed is not observable [m/s]


@final
@dataclass(frozen=True, slots=True)
class MeterReading:
    """One reading of the meters; NaN where a value is not measured."""

    stamp_ns: int
    # Of the cell; a positive current charges [V, A]
    voltage: float
    current: float
    # Of the panel; a positive current harvests [V, A]
    panel_voltage: float = math.nan
    panel_current: float = math.nan
    illuminance: float = math.nan  # at the panel [lx]
    where: TravelState | None = None  # None while the position is unknown

    @property
    def is_usable(self) -> bool:
        """Whether the cell's voltage and current are finite and within the range of a meter."""
        # Also false for NaN
        return abs(self.voltage) <= MOST_VOLTS and abs(self.current) <= MOST_AMPERES

    @property
    def panel_power(self) -> float:
        """Power of the panel. [W]"""
        return self.panel_voltage * self.panel_current

    @property
    def plausible_panel_power(self) -> float:
        """Power of the panel, or 0 if it is not measured or outside the range of a meter. [W]"""
        is_plausible = (
            abs(self.panel_voltage) <= MOST_VOLTS and abs(self.panel_current) <= MOST_AMPERES
        )
        return self.panel_power if is_plausible else 0.0

    @property
    def cell_power(self) -> float:
        """Power into the cell at its terminals. [W]"""
        return self.voltage * self.current
