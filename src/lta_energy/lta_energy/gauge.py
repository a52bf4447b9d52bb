"""
The drone's own idea of its charge over a day: coulombs counted, corrected by resting voltages.

A Kalman filter of one number. Counting drifts by the errors of the current's meter; the voltage of
a cell that hardly works tells the charge by the slope of its resting voltage. It never sees the
true charge.
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
    """Counted state of charge and its standard deviation. [1]"""

    charge: float
    deviation: float


def update_gauge(
    cell: BatteryModel, gauge: ChargeGauge, voltage: float, current: float, dt: float
) -> ChargeGauge:
    """
    Return the gauge after a while.

    Parameters
    ----------
    cell : Battery
        As the drone believes it.
    gauge : Gauge
        Before.
    voltage, current : float
        As metered. [V, A]
    dt : float
        Time. [s]

    """
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
    """Return the gauge after a current was counted for a while. [A, s]"""
    error = (SCALE * abs(current) + OFFSET) * dt / cell.capacity
    return ChargeGauge(
        count_charge(gauge.charge, current, cell.capacity, dt), gauge.deviation + error
    )
