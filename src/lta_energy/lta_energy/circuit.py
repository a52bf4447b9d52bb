"""
One step of cell, panel and loads together, with what it does to the books.

The only place where a mission meets the electricity: on the perch in steps of many seconds, in
flight in control periods, compiled. Plain scalars and tuples. Signs as in `battery`.
"""

from typing import NamedTuple

from lta_energy.battery import advance, Battery, open_circuit_voltage, stored_energy

BROWN_OUT = 3.0  # V at the terminals: below it the controller of a one-cell drone resets (assumed)


class Store(NamedTuple):
    """The cell: state of charge, terminal voltage and current. [1, V, A]"""

    charge: float
    voltage: float
    current: float


class Flow(NamedTuple):
    """Energy since some start: harvested, left unharvested, consumed, lost as heat. [J]"""

    harvested: float
    curtailed: float
    consumed: float
    lost: float


NO_FLOW = Flow(0.0, 0.0, 0.0, 0.0)


def resting(charge: float) -> Store:
    """Return a cell at rest at a state of charge."""
    return Store(charge, open_circuit_voltage(charge), 0.0)


def held(cell: Battery, store: Store) -> float:
    """Return what a cell holds. [J]"""
    return stored_energy(store.charge, cell.capacity)


def fed(
    cell: Battery, store: Store, flow: Flow, income: float, asked: float, dt: float
) -> tuple[Store, Flow]:
    """
    Return cell and flow after a while at constant powers.

    A full cell takes no more: the charger leaves the rest of the light unharvested. An empty one
    gives what it can, so that less is consumed than was asked for.

    Parameters
    ----------
    cell : Battery
        Its numbers.
    store, flow : Store, Flow
        Before.
    income, asked : float
        Power that the charger could give, and what the loads want. [W]
    dt : float
        Time. [s]

    """
    capacity, resistance = cell.capacity, cell.resistance
    charge, voltage, current = advance(store.charge, income - asked, capacity, resistance, dt)
    taken = income
    if current > 0.0 and store.charge + current * dt / capacity > 1.0:
        current = (1.0 - store.charge) * capacity / dt
        voltage = open_circuit_voltage(0.5 * (store.charge + 1.0)) + resistance * current
        charge, taken = 1.0, min(asked + voltage * current, income)
    elif current < 0.0 and charge <= 0.0:
        current = -store.charge * capacity / dt
        voltage = open_circuit_voltage(0.5 * store.charge) + resistance * current
    return Store(charge, voltage, current), Flow(
        flow.harvested + taken * dt,
        flow.curtailed + (income - taken) * dt,
        flow.consumed + (taken - voltage * current) * dt,
        flow.lost + resistance * current * current * dt,
    )


def browned_out(store: Store) -> bool:
    """Tell whether the cell can no longer feed the drone."""
    return store.voltage < BROWN_OUT or store.charge <= 0.0
