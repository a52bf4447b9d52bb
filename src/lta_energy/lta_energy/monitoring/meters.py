# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Readings of the power meters, the power system that they measure, and the energy balance."""

from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple, Self

from lta_config.schema.vehicle_energy import EnergyBlock
from lta_energy.monitoring.soc_ekf import CellState, RELAXATION, RESISTANCE
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.mppt_charger import ChargerModel, convert_harvest

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
        """Power of the panel [W]."""
        return self.panel_voltage * self.panel_current

    @property
    def plausible_panel_power(self) -> float:
        """Power of the panel, or 0 if it is not measured or outside the range of a meter [W]."""
        is_plausible = (
            abs(self.panel_voltage) <= MOST_VOLTS and abs(self.panel_current) <= MOST_AMPERES
        )
        return self.panel_power if is_plausible else 0.0

    @property
    def cell_power(self) -> float:
        """Power into the cell at its terminals [W]."""
        return self.voltage * self.current


class PowerSystem(NamedTuple):
    """The cell and the charger of a vehicle."""

    cell: BatteryModel
    charger: ChargerModel

    @classmethod
    def from_entry(cls, energy: EnergyBlock) -> Self:
        """Build cell and charger from the energy block of a vehicle file."""
        return cls(BatteryModel.from_energy(energy), ChargerModel.from_energy(energy))

    def charger_output(self, harvest: float) -> float:
        """Return the charger's output for a measured panel power; 0 if not measured [W]."""
        if not math.isfinite(harvest):
            return 0.0
        # No tracking factor here: the measured panel power already contains it
        return convert_harvest(self.charger, harvest)


@final
@dataclass(frozen=True, slots=True)
class EnergyBalance:
    """Energy since the start [J]."""

    harvested: float = 0.0  # from the panel
    consumed: float = 0.0  # by electronics and rotors
    lost: float = 0.0  # as heat in cell and charger
    stored: float = 0.0  # change of the energy in the cell; negative after a net discharge

    @property
    def imbalance(self) -> float:
        """Residual of the balance: harvested - consumed - lost - stored [J]."""
        return self.harvested - self.consumed - self.lost - self.stored


def update_energy_balance(
    books: EnergyBalance,
    aboard: PowerSystem,
    state: CellState,
    last: MeterReading,
    reading: MeterReading,
) -> EnergyBalance:
    """
    Add the interval between two usable readings to the balance.

    The residual of the balance shows how far model and meters disagree.
    """
    dt = (reading.stamp_ns - last.stamp_ns) * 1e-9
    # Trapezoidal means over the interval
    current = 0.5 * (last.current + reading.current)
    squared = 0.5 * (last.current**2 + reading.current**2)
    harvest = 0.5 * (last.plausible_panel_power + reading.plausible_panel_power)
    charger_power = 0.5 * (
        aboard.charger_output(last.panel_power) + aboard.charger_output(reading.panel_power)
    )
    load = charger_power - 0.5 * (last.cell_power + reading.cell_power)
    # Charger loss + resistive heat R I^2 + heat of the relaxation branch u I
    loss = (
        harvest
        - charger_power
        + state.mean[RESISTANCE] * aboard.cell.resistance * squared
        + state.mean[RELAXATION] * current
    )
    return EnergyBalance(
        harvested=books.harvested + harvest * dt,
        consumed=books.consumed + load * dt,
        lost=books.lost + loss * dt,
        stored=books.stored + state.resting_voltage * current * dt,
    )
