"""
Estimate the state of charge over days: coulomb counting, corrected by resting voltages.

This is a scalar Kalman filter. Coulomb counting drifts with the errors of the current meter; the
voltage of a cell at low current gives the charge through the slope of the open-circuit voltage.
The gauge never uses the true charge.
"""

from typing import NamedTuple

from lta_model.electrical.battery import (
    BatteryModel,
    integrate_charge,
    open_circuit_voltage,
    state_of_charge,
)

SCALE = 0.002  # of the current: INA219 data sheet, as `lta_sim.sensors.power`
OFFSET = 4e-4  # A: the same
VOLTAGE = 0.01  # V, error of a resting voltage: meter, chart and relaxation (assumed)
QUIET = 0.1  # A; below this current the cell counts as resting
NARROW = 0.02  # state of charge to either side over which the slope is taken


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
    # Remove the steady-state drop: on the perch the RC pair has settled
    resting = voltage - (cell.resistance + cell.relaxation_resistance) * current
    indicated = state_of_charge(resting)
    span = open_circuit_voltage(indicated + NARROW) - open_circuit_voltage(indicated - NARROW)
    # Voltage noise divided by the slope dV/dcharge; the chart's flat parts give little information
    noise = VOLTAGE * 2.0 * NARROW / max(span, 1e-3)
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
    error = (SCALE * abs(current) + OFFSET) * dt / cell.capacity
    return ChargeGauge(
        integrate_charge(gauge.charge, current, cell.capacity, dt), gauge.deviation + error
    )
