"""
Estimate the state of charge over days: coulomb counting, corrected by resting voltages.

This is a scalar Kalman filter. Coulomb counting drifts with the errors of the current meter; the
voltage of a cell at low current gives the charge through the slope of the open-circuit voltage.
The gauge never uses the true charge.
"""

from typing import NamedTuple

from lta_model.electrical.battery import (
    BatteryModel,
    count_charge,
    open_circuit_voltage,
    state_of_charge,
)

SCALE = 0.002  # of the current: INA219 data sheet, as `lta_sim.sensors.power`
OFFSET = 4e-4  # A: the same
VOLTAGE = 0.01  # V, of a resting voltage: meter, chart and what relaxes yet (assumed)
QUIET = 0.1  # A: a cell with less than that rests
NARROW = 0.02  # of the charge, to either side: over which the slope is taken


class ChargeGauge(NamedTuple):
    """Estimated state of charge and its standard deviation. [1]"""

    charge: float
    deviation: float


def update_gauge(
    cell: BatteryModel, gauge: ChargeGauge, voltage: float, current: float, dt: float
) -> ChargeGauge:
    """Update the gauge with a measured voltage [V] and current [A] after a time step [s]."""
    gauge = propagate_gauge(cell, gauge, current, dt)
    if abs(current) > QUIET:
        return gauge
    resting = voltage - (cell.resistance + cell.relaxation_resistance) * current
    told = state_of_charge(resting)
    span = open_circuit_voltage(told + NARROW) - open_circuit_voltage(told - NARROW)
    noise = VOLTAGE * 2.0 * NARROW / max(span, 1e-3)
    # One voltage a minute is no news every second: its error stays the same for long.
    weight = gauge.deviation**2 / (gauge.deviation**2 + noise**2 * max(3600.0 / dt, 1.0))
    return ChargeGauge(
        gauge.charge + weight * (told - gauge.charge), gauge.deviation * (1.0 - weight) ** 0.5
    )


def propagate_gauge(
    cell: BatteryModel, gauge: ChargeGauge, current: float, dt: float
) -> ChargeGauge:
    """Count a current [A] over a time step [s], and grow the deviation by the meter's errors."""
    error = (SCALE * abs(current) + OFFSET) * dt / cell.capacity
    return ChargeGauge(
        count_charge(gauge.charge, current, cell.capacity, dt), gauge.deviation + error
    )
