"""
Fit a single-diode model to a solar cell's data sheet.

With the ideality given, the three points of the data sheet (short circuit, open circuit, maximum
power) are linear in light current, saturation current and shunt conductance for any series
resistance. The resistance is the one that puts the maximum of the power at the given point.
"""

from functools import lru_cache
from typing import NamedTuple

from lta_config.errors import BadInput
from lta_config.schema.cell_file import CellFile, CellRatings
import numpy as np

THERMAL = 0.025692579  # V, k T / q at 25 degC
STEPS = 200  # of bisection
MARGIN = 1e-6  # keeps the equations apart


class SingleDiodeModel(NamedTuple):
    """One panel at standard conditions."""

    # Currents [A]
    light: float
    saturation: float
    thermal: float  # ideality times thermal voltage of all junctions [V]
    # Series resistance [ohm] and shunt conductance [S]
    series: float
    shunt: float


@lru_cache(maxsize=16)  # the fit takes longer than the rest of loading a vehicle
def fit_diode(cell: CellFile) -> SingleDiodeModel:
    """
    Return the diode whose curve passes the points of a data sheet.

    Raise `BadInput` if there is none: the curve between the points is too square or too round.
    """
    data = cell.electrical
    # From `high` on the junction would be above the open-circuit voltage at the maximum.
    # Bisection on the series resistance
    low, high = 0.0, (1.0 - MARGIN) * (data.open_circuit.si - data.voltage.si) / data.current.si
    if _slope_at_maximum(data, low) < 0.0:
        raise BadInput(
            f'No diode model with an ideality factor of {data.ideality.si:g} fits the '
            f'solar cell {cell.name}: its current-voltage curve is too square. In the cell '
            'file, lower ideality, or check voltage and current at maximum power.'
        )
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        if _slope_at_maximum(data, middle) > 0.0:
            low = middle
        else:
            high = middle
    diode = _solve_three_points(data, low)
    if diode.shunt < 0.0 or diode.saturation <= 0.0:
        raise BadInput(
            f'No diode model with an ideality factor of {data.ideality.si:g} fits the '
            f'solar cell {cell.name}: its current-voltage curve is too round. In the cell '
            'file, raise ideality, or check voltage and current at maximum power.'
        )
    return diode


def _solve_three_points(data: CellRatings, resistance: float) -> SingleDiodeModel:
    """Return the diode through the three points, for a series resistance. [ohm]"""
    a = data.ideality.si * data.junctions * THERMAL
    voltages = np.array([0.0, data.open_circuit.si, data.voltage.si])
    currents = np.array([data.short_circuit.si, 0.0, data.current.si])
    junction = voltages + resistance * currents
    # Diode equation at short circuit, open circuit and maximum power
    dark = np.expm1(junction / a)
    # Scaled by dark[1]: the exponential is huge, and the system would be ill-conditioned
    matrix = np.stack([np.ones(3), -dark / dark[1], -junction], axis=1)
    light, open_, shunt = np.linalg.solve(matrix, currents).tolist()
    return SingleDiodeModel(light, open_ / float(dark[1]), a, resistance, shunt)


def _slope_at_maximum(data: CellRatings, resistance: float) -> float:
    """Return dP/dV at the maximum of the sheet; it falls as the resistance grows. [A]"""
    diode = _solve_three_points(data, resistance)
    junction = data.voltage.si + resistance * data.current.si
    conductance = diode.saturation / diode.thermal * np.exp(junction / diode.thermal) + diode.shunt
    # dI/dV at the terminals: junction conductance in series with the resistance
    slope = conductance / (1.0 + resistance * conductance)
    return data.current.si - data.voltage.si * float(slope)
