"""Keep the energy balance: harvested, consumed, lost and stored energy, and the residual."""

from dataclasses import dataclass
from typing import final

from lta_energy.monitoring.power_system import PowerSystem
from lta_energy.monitoring.reading import MeterReading
from lta_energy.monitoring.soc_ekf import CellState, RELAXATION, RESISTANCE


@final
@dataclass(frozen=True, slots=True)
class EnergyBalance:
    """Energy since the start. [J]"""

    harvested: float = 0.0  # from the panel
    consumed: float = 0.0  # by electronics and rotors
    lost: float = 0.0  # as heat in cell and charger
    stored: float = 0.0  # change of the energy in the cell; negative after a net discharge

    @property
    def imbalance(self) -> float:
        """Residual of the balance: harvested - consumed - lost - stored. [J]"""
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
