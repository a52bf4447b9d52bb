"""
Advance cell, charger and loads over one time step and keep the energy totals.

Used on the perch; in flight, `lta_sim.supply_step` calls the same power path
(`lta_model.electrical.charger`).
"""

from typing import NamedTuple

from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.charger import (
    advance_power_path,
    charger_output,
    ChargerModel,
    PowerFlow,
    resting_flow,
    total_stored_energy,
)


class EnergyTotals(NamedTuple):
    """Energy harvested, available but not harvested, consumed, and lost as heat. [J]"""

    harvested: float
    curtailed: float
    consumed: float
    lost: float


NOTHING = EnergyTotals(0.0, 0.0, 0.0, 0.0)

__all__ = [
    'NOTHING',
    'ChargerModel',
    'EnergyTotals',
    'PowerFlow',
    'add_totals',
    'charger_output',
    'resting_flow',
    'step_circuit',
    'total_stored_energy',
]


def add_totals(one: EnergyTotals, other: EnergyTotals) -> EnergyTotals:
    """Add two totals field by field."""
    return EnergyTotals(*(a + b for a, b in zip(one, other, strict=True)))


def step_circuit(
    cell: BatteryModel,
    charger: ChargerModel,
    store: PowerFlow,
    spent: EnergyTotals,
    available: float,
    load: float,
    dt: float,
) -> tuple[PowerFlow, EnergyTotals]:
    """
    Advance the power path and the energy totals by one step at constant light and load.

    `available`: maximum power of the array [W]. `load`: power that the loads request [W]. `dt`:
    step [s].
    """
    store = advance_power_path(cell, charger, store, available, load, dt)
    # While the charger is off, nothing counts as curtailed: the light is too dim for its own draw
    working = charger_output(charger, available) > 0.0
    tracked = available * charger.tracking if working else store.harvested
    return store, EnergyTotals(
        spent.harvested + store.harvested * dt,
        spent.curtailed + (tracked - store.harvested) * dt,
        spent.consumed + store.consumed * dt,
        spent.lost + store.lost * dt,
    )
