"""
Cell, charger and loads of a mission over a while, with what it does to the books.

The only place where a mission on the perch meets the power path
(`lta_model.electrical.charger`); in flight the same goes through `lta_sim.supply_step`.
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
    """Energy since some start: harvested, left unharvested, consumed, lost as heat. [J]"""

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
    """Return the sum of two."""
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
    Return the power path and the books after a while at constant light and load.

    Parameters
    ----------
    cell, charger : Battery, Charger
        Their numbers.
    store, spent : Flow, Spent
        Before.
    available : float
        Largest power of the array. [W]
    asked : float
        What the loads want. [W]
    dt : float
        Time. [s]

    """
    store = advance_power_path(cell, charger, store, available, load, dt)
    working = charger_output(charger, available) > 0.0
    tracked = available * charger.tracking if working else store.harvested
    return store, EnergyTotals(
        spent.harvested + store.harvested * dt,
        spent.curtailed + (tracked - store.harvested) * dt,
        spent.consumed + store.consumed * dt,
        spent.lost + store.lost * dt,
    )
