"""
Cell, charger and loads of a mission over a while, with what it does to the books.

The only place where a mission on the perch meets the power path
(`lta_model.electrical.power_path`); in flight the same goes through `lta_sim.supply_step`.
"""

from typing import NamedTuple

from lta_model.electrical.battery import Battery
from lta_model.electrical.power_path import at_rest, Charger, feed, Flow, held, output


class Spent(NamedTuple):
    """Energy since some start: harvested, left unharvested, consumed, lost as heat. [J]"""

    harvested: float
    curtailed: float
    consumed: float
    lost: float


NOTHING = Spent(0.0, 0.0, 0.0, 0.0)

__all__ = ['NOTHING', 'Charger', 'Flow', 'Spent', 'added', 'at_rest', 'fed', 'held', 'output']


def added(one: Spent, other: Spent) -> Spent:
    """Return the sum of two."""
    return Spent(*(a + b for a, b in zip(one, other, strict=True)))


def fed(
    cell: Battery,
    charger: Charger,
    store: Flow,
    spent: Spent,
    available: float,
    asked: float,
    dt: float,
) -> tuple[Flow, Spent]:
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
    store = feed(cell, charger, store, available, asked, dt)
    working = output(charger, available) > 0.0
    tracked = available * charger.tracking if working else store.harvested
    return store, Spent(
        spent.harvested + store.harvested * dt,
        spent.curtailed + (tracked - store.harvested) * dt,
        spent.consumed + store.consumed * dt,
        spent.lost + store.lost * dt,
    )
