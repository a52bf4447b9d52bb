r"""
How long it lasts: time to empty and to full at the mean load, each with a standard deviation.

A cell is empty where it can no longer give the mean power P above the cut-off voltage: at the
charge whose resting voltage is :math:`V_c + R P / V_c`. Between here and there it stores W(s); at
the power p that leaves its chemistry, losses included, the time is :math:`T = W C / (C_0 p)`. To
first order its variance is that of charge and capacity (with what the filter knows of both
together) and of p.

Full is by the same rule and leaves out that a charger tapers its current off at the end.
"""

import math
from typing import NamedTuple

from lta_energy.monitoring.belief import Belief, CHARGE, INVERSE, RESISTANCE
from lta_model.electrical.battery import (
    Battery,
    open_circuit_voltage,
    state_of_charge,
    stored_energy,
)


class Time(NamedTuple):
    """A time and its standard deviation [s]; infinite where it never comes."""

    mean: float
    deviation: float


UNKNOWN = Time(math.nan, math.nan)
NEVER = Time(math.inf, math.inf)


def empty_charge(cell: Battery, belief: Belief, power: float) -> float:
    """Return the charge at which a power [W] pulls the cell down to its cut-off. [1]"""
    resistance = belief.mean[RESISTANCE] * (cell.resistance + cell.relaxation_resistance)
    return state_of_charge(
        cell.discharge_cutoff + resistance * max(power, 0.0) / cell.discharge_cutoff
    )


def energy_between(cell: Battery, belief: Belief, low: float, high: float) -> float:
    """Return what the cell stores between two charges; negative where low is above high. [J]"""
    capacity = cell.capacity / belief.mean[INVERSE]
    return stored_energy(high, capacity) - stored_energy(low, capacity)


def to_empty(cell: Battery, belief: Belief, power: float, deviation: float) -> Time:
    """
    Return how long the cell lasts.

    Parameters
    ----------
    cell : Battery
        The cell's file.
    belief : Belief
        What is known of it.
    power, deviation : float
        Mean power out of its chemistry, and the standard deviation of that. [W]

    """
    if power <= 0.0:
        return NEVER
    energy = energy_between(cell, belief, empty_charge(cell, belief, power), belief.charge)
    return _time(cell, belief, max(energy, 0.0), power, deviation, 1.0)


def to_full(cell: Battery, belief: Belief, power: float, deviation: float) -> Time:
    """Return how long the cell takes until it is full [s]; as `to_empty`, power being negative."""
    if power >= 0.0:
        return NEVER
    energy = energy_between(cell, belief, belief.charge, 1.0)
    return _time(cell, belief, energy, -power, deviation, -1.0)


def _time(
    cell: Battery, belief: Belief, energy: float, power: float, deviation: float, sign: float
) -> Time:
    """Return energy by power; a larger charge makes it longer (sign 1) or shorter (-1)."""
    p, inverse = belief.spread, belief.mean[INVERSE]
    time = energy / power
    by_charge = sign * open_circuit_voltage(belief.charge) * cell.capacity / inverse / power
    by_inverse = -time / inverse
    by_power = -time / power
    variance = (
        by_charge * by_charge * p[CHARGE][CHARGE]
        + 2.0 * by_charge * by_inverse * p[CHARGE][INVERSE]
        + by_inverse * by_inverse * p[INVERSE][INVERSE]
        + by_power * by_power * deviation * deviation
    )
    return Time(time, math.sqrt(max(variance, 0.0)))
