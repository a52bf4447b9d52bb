"""
One LiPo cell: open-circuit voltage by state of charge behind a series resistance.

Signs as in sensor_msgs/BatteryState: a positive current or power charges the cell. The functions
take and return scalars and make nothing on the heap, so that numba compiles them. No relaxation,
temperature or ageing yet.
"""

from typing import Annotated, final, Self

from lta_config.files import Record
from lta_config.vehicle_energy import Energy
from pydantic import Field

# Resting voltage in steps of 5 % from empty to full: the chart that hobby LiPo cells are sold with
# (ampow.com, "LiPo voltage chart"). Assumed for this cell, not measured on it. [V]
OPEN_CIRCUIT = (
    3.27, 3.61, 3.69, 3.71, 3.73, 3.75, 3.77, 3.79, 3.80, 3.82,
    3.84, 3.85, 3.87, 3.91, 3.95, 3.98, 4.02, 4.08, 4.11, 4.15, 4.20,
)  # fmt: skip
INTERVALS = len(OPEN_CIRCUIT) - 1


@final
class Battery(Record):
    """
    One cell.

    Attributes
    ----------
    capacity : float
        Charge of the full cell. [C]
    resistance : float
        Series resistance. [ohm]

    """

    capacity: Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
    resistance: Annotated[float, Field(ge=0.0, allow_inf_nan=False)]

    @classmethod
    def of(cls, energy: Energy) -> Self:
        """Return the cell of a vehicle file."""
        return cls(capacity=energy.battery.capacity.si, resistance=energy.battery.resistance.si)


def open_circuit_voltage(charge: float) -> float:
    """Return the resting voltage at a state of charge, 0 to 1 and clipped there. [V]"""
    place = min(max(charge, 0.0), 1.0) * INTERVALS
    below = min(int(place), INTERVALS - 1)
    rise = OPEN_CIRCUIT[below + 1] - OPEN_CIRCUIT[below]
    return OPEN_CIRCUIT[below] + (place - below) * rise


def state_of_charge(voltage: float) -> float:
    """Return the state of charge, 0 to 1, whose resting voltage this is. [1]"""
    if voltage <= OPEN_CIRCUIT[0]:
        return 0.0
    for below in range(INTERVALS):
        if voltage < OPEN_CIRCUIT[below + 1]:
            rise = OPEN_CIRCUIT[below + 1] - OPEN_CIRCUIT[below]
            return (below + (voltage - OPEN_CIRCUIT[below]) / rise) / INTERVALS
    return 1.0


def stored_energy(charge: float, capacity: float) -> float:
    """
    Return the energy that the cell holds: the integral of its resting voltage over its charge.

    Parameters
    ----------
    charge : float
        State of charge, 0 to 1. [1]
    capacity : float
        Charge of the full cell. [C]

    Returns
    -------
    float
        Energy above empty, before losses in the resistance. [J]

    """
    place = min(max(charge, 0.0), 1.0) * INTERVALS
    below = min(int(place), INTERVALS - 1)
    area = 0.0
    for k in range(below):
        area += 0.5 * (OPEN_CIRCUIT[k] + OPEN_CIRCUIT[k + 1])
    rest = place - below
    rise = OPEN_CIRCUIT[below + 1] - OPEN_CIRCUIT[below]
    area += rest * (OPEN_CIRCUIT[below] + 0.5 * rest * rise)
    return area * capacity / INTERVALS


def terminal_voltage(open_circuit: float, current: float, resistance: float) -> float:
    """Return the voltage [V] at the terminals for a current [A] through a resistance [ohm]."""
    return open_circuit + resistance * current


def current_at(open_circuit: float, power: float, resistance: float) -> float:
    """
    Return the current at which the terminals take up a power.

    Parameters
    ----------
    open_circuit : float
        Resting voltage E. [V]
    power : float
        Power P into the cell; negative where it is drawn. [W]
    resistance : float
        Series resistance R. [ohm]

    Returns
    -------
    float
        The smaller root of R I^2 + E I = P, in the form that holds for R = 0. Beyond the largest
        power the cell can give, E^2 / 4R, it is the current of that power: a brown-out. [A]

    """
    root: float = max(0.0, open_circuit * open_circuit + 4.0 * resistance * power) ** 0.5
    held = max(power, -0.25 * open_circuit * open_circuit / resistance) if resistance else power
    return 2.0 * held / (open_circuit + root)


def count(charge: float, current: float, capacity: float, dt: float) -> float:
    """
    Return the state of charge after a current has flowed; clipped to 0 and 1.

    Parameters
    ----------
    charge : float
        State of charge before. [1]
    current : float
        Mean current; positive charges. [A]
    capacity : float
        Charge of the full cell. [C]
    dt : float
        Time. [s]

    """
    return min(max(charge + current * dt / capacity, 0.0), 1.0)


def advance(
    charge: float, power: float, capacity: float, resistance: float, dt: float
) -> tuple[float, float, float]:
    """
    Take up a constant power for a while: one midpoint step, of second order in dt.

    Parameters
    ----------
    charge : float
        State of charge. [1]
    power : float
        Power into the cell; negative where it is drawn. [W]
    capacity, resistance : float
        Charge of the full cell [C] and series resistance [ohm].
    dt : float
        Time step. [s]

    Returns
    -------
    tuple of float
        State of charge after the step [1], mean terminal voltage [V] and current [A].

    """
    begin = current_at(open_circuit_voltage(charge), power, resistance)
    middle = open_circuit_voltage(count(charge, begin, capacity, 0.5 * dt))
    current = current_at(middle, power, resistance)
    voltage = terminal_voltage(middle, current, resistance)
    return count(charge, current, capacity, dt), voltage, current
