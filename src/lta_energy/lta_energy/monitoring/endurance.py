"""
Estimate the time to empty and to full at the mean load, with standard deviations.

A cell is empty where it can no longer deliver the mean power P above the cut-off voltage: at the
charge whose open-circuit voltage is :math:`V_c + R P / V_c`. With W(s) the energy between here and
there and p the power drawn from the chemistry, losses included, the time is :math:`T = W C / (C_0
p)`. Its variance is propagated to first order from charge, capacity (with their covariance) and p.

The time to full follows the same rule and neglects that a charger tapers its current at the end.
"""

import math
from typing import NamedTuple

from lta_energy.monitoring.soc_ekf import CellState, CHARGE, INVERSE, RESISTANCE
from lta_model.electrical.battery import BatteryModel, state_of_charge, stored_energy


class TimeEstimate(NamedTuple):
    """A time and its standard deviation [s]; infinite if it is never reached."""

    mean: float
    deviation: float


UNKNOWN = TimeEstimate(math.nan, math.nan)
NEVER = TimeEstimate(math.inf, math.inf)


def empty_charge(cell: BatteryModel, state: CellState, power: float) -> float:
    """Return the charge at which a power [W] pulls the voltage down to the cut-off. [1]"""
    resistance = state.mean[RESISTANCE] * (cell.resistance + cell.relaxation_resistance)
    return state_of_charge(
        cell.discharge_cutoff + resistance * max(power, 0.0) / cell.discharge_cutoff
    )


def energy_between(cell: BatteryModel, state: CellState, low: float, high: float) -> float:
    """Return the energy between two charges; negative where low is above high. [J]"""
    capacity = cell.capacity / state.mean[INVERSE]
    return stored_energy(high, capacity) - stored_energy(low, capacity)


def estimate_discharge_time(
    cell: BatteryModel, state: CellState, power: float, deviation: float
) -> TimeEstimate:
    """Estimate the time to empty from the mean power and its standard deviation. [W]"""
    if power <= 0.0:
        return NEVER
    energy = energy_between(cell, state, empty_charge(cell, state, power), state.charge)
    return _energy_over_power(cell, state, max(energy, 0.0), power, deviation, 1.0)


def estimate_charging_time(
    cell: BatteryModel, state: CellState, power: float, deviation: float
) -> TimeEstimate:
    """Estimate the time to full; the power is negative while the cell is charged. [W]"""
    if power >= 0.0:
        return NEVER
    energy = energy_between(cell, state, state.charge, 1.0)
    return _energy_over_power(cell, state, energy, -power, deviation, -1.0)


def _energy_over_power(
    cell: BatteryModel,
    state: CellState,
    energy: float,
    power: float,
    deviation: float,
    sign: float,
) -> TimeEstimate:
    """Return energy by power; more charge makes it longer (`sign` 1) or shorter (-1)."""
    p, inverse = state.spread, state.mean[INVERSE]
    time = energy / power
    # Partial derivatives of the time by charge, inverse capacity and power
    by_charge = sign * state.resting_voltage * cell.capacity / inverse / power
    by_inverse = -time / inverse
    by_power = -time / power
    # The charge is correlated with the capacity, but neither with the load
    variance = (
        by_charge * by_charge * p[CHARGE][CHARGE]
        + 2.0 * by_charge * by_inverse * p[CHARGE][INVERSE]
        + by_inverse * by_inverse * p[INVERSE][INVERSE]
        + by_power * by_power * deviation * deviation
    )
    return TimeEstimate(time, math.sqrt(max(variance, 0.0)))
