# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
One LiPo cell: open-circuit voltage by state of charge, a series resistance and one RC pair.

    V = E(charge) + U + R I          charge' = I / capacity          U' = (R1 I - U) / tau

Signs as in sensor_msgs/BatteryState: positive current or power charges the cell. The states are
the charge and the relaxation voltage U; temperature and age are constant. The functions take and
return scalars and allocate nothing, so that numba compiles them. `electrical.mppt_charger` has the
limits of voltage and current.
"""

import math
from typing import Annotated, final, Self

from lta_config.files import StrictModel
from lta_config.schema.vehicle_energy import EnergyBlock
from pydantic import Field

# Resting voltage in steps of 5 % from empty to full: the chart that hobby LiPo cells are sold with
# (ampow.com, "LiPo voltage chart"). Assumed for this cell, not measured on it. [V]
OPEN_CIRCUIT = (
    3.27,
    3.61,
    3.69,
    3.71,
    3.73,
    3.75,
    3.77,
    3.79,
    3.80,
    3.82,
    3.84,
    3.85,
    3.87,
    3.91,
    3.95,
    3.98,
    4.02,
    4.08,
    4.11,
    4.15,
    4.20,
)
CHARGE_INTERVALS = len(OPEN_CIRCUIT) - 1

# Loss of capacity at which a cell counts as worn out, its resistance doubled (USABC)
WORN_LOSS = 0.2
ACTIVATION_ENERGY = 18.8e3  # J/mol of both resistances; assumed: they double from 25 to 0 degC
GAS_CONSTANT = 8.314462618  # J/(mol K)
COLD_LOSS = 0.006  # of the capacity by kelvin below 25 degC; assumed: 15 % at 0 degC
ZERO_CELSIUS = 273.15  # K
ROOM_TEMPERATURE = 25.0  # degC, for which the numbers of a file stand

NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


@final
class BatteryModel(StrictModel):
    """
    One cell at its temperature and age.

    Attributes
    ----------
    capacity : float
        Charge of the full cell. [C]
    resistance : float
        Series resistance R. [ohm]
    relaxation_resistance, relaxation_time : float
        Resistance R1 [ohm] and time constant tau [s] of the RC pair; none by default.
    discharge_cutoff : float
        Voltage under load below which the supply fails. [V]
    charge_cutoff, charge_current : float
        Largest charging voltage [V] and current [A].

    """

    capacity: Positive
    resistance: NotNegative
    relaxation_resistance: NotNegative = 0.0
    relaxation_time: Positive = 1.0
    discharge_cutoff: Positive = 3.0
    charge_cutoff: Positive = 4.2
    charge_current: Positive = 1000.0

    @classmethod
    def from_energy(cls, energy: EnergyBlock) -> Self:
        """Return the cell of a vehicle file."""
        data = energy.battery
        # Resistance doubles at the loss of capacity that counts as worn out
        worse = (1.0 + data.age.si / WORN_LOSS) * resistance_factor(data.temperature.si)
        left = (1.0 - data.age.si) * capacity_factor(data.temperature.si)
        return cls(
            capacity=data.capacity.si * left,
            resistance=data.resistance.si * worse,
            relaxation_resistance=data.relaxation_resistance.si * worse,
            relaxation_time=data.relaxation_time.si,
            discharge_cutoff=data.discharge_cutoff.si,
            charge_cutoff=data.charge_cutoff.si,
            charge_current=data.charge_current.si,
        )


def resistance_factor(celsius: float) -> float:
    """Return the resistance at a temperature [degC] relative to 25 degC (Arrhenius) [1]."""
    # Arrhenius: exp(E / R (1/T - 1/T0))
    there, here = 1.0 / (celsius + ZERO_CELSIUS), 1.0 / (ROOM_TEMPERATURE + ZERO_CELSIUS)
    return math.exp(ACTIVATION_ENERGY / GAS_CONSTANT * (there - here))


def capacity_factor(celsius: float) -> float:
    """Return the capacity at a temperature [degC] relative to 25 degC, at most 1 [1]."""
    return 1.0 - COLD_LOSS * max(ROOM_TEMPERATURE - celsius, 0.0)


def open_circuit_voltage(charge: float) -> float:
    """Return the resting voltage at a state of charge, clipped to 0 and 1 [V]."""
    # Linear interpolation in the table; at 1.0 the last interval is used
    place = min(max(charge, 0.0), 1.0) * CHARGE_INTERVALS
    below = min(int(place), CHARGE_INTERVALS - 1)
    rise = OPEN_CIRCUIT[below + 1] - OPEN_CIRCUIT[below]
    return OPEN_CIRCUIT[below] + (place - below) * rise


def state_of_charge(voltage: float) -> float:
    """Return the state of charge, 0 to 1, whose resting voltage this is [1]."""
    if voltage <= OPEN_CIRCUIT[0]:
        return 0.0
    for below in range(CHARGE_INTERVALS):
        if voltage < OPEN_CIRCUIT[below + 1]:
            rise = OPEN_CIRCUIT[below + 1] - OPEN_CIRCUIT[below]
            return (below + (voltage - OPEN_CIRCUIT[below]) / rise) / CHARGE_INTERVALS
    return 1.0


def stored_energy(charge: float, capacity: float) -> float:
    """
    Return the energy above empty: the integral of the resting voltage over the charge [J].

    Losses in the resistances are not subtracted; `charge` is 0 to 1, `capacity` in C.
    """
    place = min(max(charge, 0.0), 1.0) * CHARGE_INTERVALS
    below = min(int(place), CHARGE_INTERVALS - 1)
    # Trapezoidal rule is exact, because the curve is piecewise linear
    area = 0.0
    for k in range(below):
        area += 0.5 * (OPEN_CIRCUIT[k] + OPEN_CIRCUIT[k + 1])
    rest = place - below
    rise = OPEN_CIRCUIT[below + 1] - OPEN_CIRCUIT[below]
    # Part of the last interval, up to the state of charge
    area += rest * (OPEN_CIRCUIT[below] + 0.5 * rest * rise)
    return area * capacity / CHARGE_INTERVALS


def mean_open_circuit_voltage(before: float, after: float) -> float:
    """Return the mean resting voltage between two states of charge, exactly [V]."""
    # Same interval: the curve is linear between the two, and no division by their difference
    if int(before * CHARGE_INTERVALS) == int(after * CHARGE_INTERVALS):
        return 0.5 * (open_circuit_voltage(before) + open_circuit_voltage(after))
    return (stored_energy(after, 1.0) - stored_energy(before, 1.0)) / (after - before)


def relaxation_energy(cell: BatteryModel, relaxation: float) -> float:
    """Return the energy in the capacitor of the RC pair at a relaxation voltage [V] [J]."""
    if cell.relaxation_resistance <= 0.0:
        return 0.0
    # C U^2 / 2 with C = tau / R1
    return 0.5 * cell.relaxation_time / cell.relaxation_resistance * relaxation * relaxation


def terminal_voltage(open_circuit: float, current: float, resistance: float) -> float:
    """Return the voltage [V] at the terminals for a current [A] through a resistance [ohm]."""
    return open_circuit + resistance * current


def current_for_power(open_circuit: float, power: float, resistance: float) -> float:
    """
    Return the current at which the terminals take up a power [A].

    It is the smaller root of R I^2 + E I = P with E the voltage behind the series resistance [V],
    in the form that holds for R = 0. Beyond the largest power the cell can give, E^2 / 4R, it is
    the current of that power. Negative power and current discharge.
    """
    # Negative below the largest power the cell can give: clipped there
    root: float = max(0.0, open_circuit * open_circuit + 4.0 * resistance * power) ** 0.5
    # Maximum power transfer, E^2 / 4R, at half of the voltage
    held = max(power, -0.25 * open_circuit * open_circuit / resistance) if resistance else power
    # Rationalised quadratic formula: no cancellation for small R
    return 2.0 * held / (open_circuit + root)


def integrate_charge(charge: float, current: float, capacity: float, dt: float) -> float:
    """Return the state of charge after a mean current [A] during dt [s], clipped to 0 and 1."""
    return min(max(charge + current * dt / capacity, 0.0), 1.0)


def relax_voltage(
    cell: BatteryModel, relaxation: float, current: float, dt: float
) -> tuple[float, float]:
    """Return the relaxation voltage after a constant current [A] for dt > 0 [s], and its mean."""
    # Voltage that the RC pair approaches
    final_ = cell.relaxation_resistance * current
    x = dt / cell.relaxation_time
    # 1 - exp(-x) without cancellation for short steps
    gone = -math.expm1(-x)
    return (
        relaxation + (final_ - relaxation) * gone,
        final_ + (relaxation - final_) * gone / x,
    )


def resistive_heat(cell: BatteryModel, relaxation: float, current: float, dt: float) -> float:
    """Return the mean heat in both resistances; parameters as `relax_voltage` [W]."""
    warmth = cell.resistance * current * current
    if cell.relaxation_resistance <= 0.0:
        return warmth
    last = cell.relaxation_resistance * current
    first, x = relaxation - last, dt / cell.relaxation_time
    # Mean of (last + first exp(-t / tau))^2 over the step
    square = (
        last * last
        - 2.0 * last * first * math.expm1(-x) / x
        - 0.5 * first * first * math.expm1(-2.0 * x) / x
    )
    return warmth + square / cell.relaxation_resistance


def advance_cell(
    cell: BatteryModel, charge: float, relaxation: float, power: float, dt: float
) -> tuple[float, float, float, float]:
    """
    Advance the cell at constant power [W] by one midpoint step dt [s].

    The power is met to second order in dt; voltage, current and stored energy agree exactly, so
    that the energy balance closes at any step. The current stops where the cell is empty or full.

    Returns
    -------
    tuple of float
        State of charge [1] and relaxation voltage [V] after the step, mean terminal voltage [V]
        and current [A].

    """
    resistance, capacity = cell.resistance, cell.capacity
    # Euler half step to the middle, for second order
    begin = current_for_power(open_circuit_voltage(charge) + relaxation, power, resistance)
    middle = open_circuit_voltage(integrate_charge(charge, begin, capacity, 0.5 * dt))
    middle += relax_voltage(cell, relaxation, begin, dt)[1]
    demand = current_for_power(middle, power, resistance)
    after = integrate_charge(charge, demand, capacity, dt)
    # Clipped at empty or full: the mean current that really flowed
    current = (after - charge) * capacity / dt if after <= 0.0 or after >= 1.0 else demand
    relaxed, mean = relax_voltage(cell, relaxation, current, dt)
    voltage = terminal_voltage(
        mean_open_circuit_voltage(charge, after) + mean, current, resistance
    )
    return after, relaxed, voltage, current
