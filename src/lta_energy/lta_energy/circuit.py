# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The cell on the perch over a time step: power path, energy totals, and the gauge of its charge.

In flight, `lta_sim.supply` calls the same power path (`lta_model.electrical.mppt_charger`).

The gauge is a scalar Kalman filter. Coulomb counting drifts with the errors of the current meter;
the voltage of a cell at low current gives the charge through the slope of the open-circuit
voltage. The gauge never uses the true charge.
"""

from typing import NamedTuple

from lta_model.electrical.battery import (
    BatteryModel,
    integrate_charge,
    open_circuit_voltage,
    state_of_charge,
)
from lta_model.electrical.mppt_charger import (
    advance_power_path,
    charger_output,
    ChargerModel,
    PowerFlow,
)


class EnergyTotals(NamedTuple):
    """Energy harvested, available but not harvested, consumed, and lost as heat [J]."""

    harvested: float
    curtailed: float
    consumed: float
    lost: float


NO_ENERGY = EnergyTotals(0.0, 0.0, 0.0, 0.0)


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


METER_GAIN_ERROR = 0.002  # of the current: INA219 data sheet, as `lta_sim.supply`
METER_OFFSET = 4e-4  # A: the same
# V, error of a resting voltage: meter, chart and relaxation (assumed)
RESTING_VOLTAGE_ERROR = 0.01
RESTING_CURRENT = 0.1  # A; below this current the cell counts as resting
SLOPE_REACH = 0.02  # state of charge to either side over which the slope is taken


class ChargeGauge(NamedTuple):
    """Estimated state of charge and its standard deviation [1]."""

    charge: float
    deviation: float


def update_gauge(
    cell: BatteryModel, gauge: ChargeGauge, voltage: float, current: float, dt: float
) -> ChargeGauge:
    """Update the gauge with a measured voltage [V] and current [A] after a time step [s]."""
    gauge = propagate_gauge(cell, gauge, current, dt)
    if abs(current) > RESTING_CURRENT:
        return gauge
    # Remove the steady-state drop: on the perch the RC pair has settled
    resting = voltage - (cell.resistance + cell.relaxation_resistance) * current
    indicated = state_of_charge(resting)
    span = open_circuit_voltage(indicated + SLOPE_REACH) - open_circuit_voltage(
        indicated - SLOPE_REACH
    )
    # Voltage noise divided by the slope dV/dcharge; the chart's flat parts give little information
    noise = RESTING_VOLTAGE_ERROR * 2.0 * SLOPE_REACH / max(span, 1e-3)
    # Kalman gain. The voltage error stays the same for about an hour, so each of the many
    # updates within an hour gets only its share of the information.
    weight = gauge.deviation**2 / (gauge.deviation**2 + noise**2 * max(3600.0 / dt, 1.0))
    return ChargeGauge(
        gauge.charge + weight * (indicated - gauge.charge), gauge.deviation * (1.0 - weight) ** 0.5
    )


def propagate_gauge(
    cell: BatteryModel, gauge: ChargeGauge, current: float, dt: float
) -> ChargeGauge:
    """Count a current [A] over a time step [s], and grow the deviation by the meter's errors."""
    # Systematic meter errors add up linearly, not as the root of the sum of squares
    error = (METER_GAIN_ERROR * abs(current) + METER_OFFSET) * dt / cell.capacity
    return ChargeGauge(
        integrate_charge(gauge.charge, current, cell.capacity, dt), gauge.deviation + error
    )
