# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fit a single-diode model to a solar cell's data sheet.

With the ideality given, the three points of the data sheet (short circuit, open circuit, maximum
power) are linear in light current, saturation current and shunt conductance for any series
resistance. The resistance is the one that puts the maximum of the power at the given point.

What a solar array can give: the single-diode model.

    I = L - S (exp((V + I R) / a) - 1) - (V + I R) G

Light current L and shunt conductance G go with the irradiance (De Soto, Klein and Beckman 2006).
Irradiance is that of sunlight: other light is multiplied by its spectral factor before. Further,
a with the absolute temperature T, S with T^3 exp(-gap / (ideality k T)) (as in PVsyst); R stays.
`lta_model.electrical.panel` derives the numbers from a data sheet. All junctions of an
array are alike and see the same light.

At a junction voltage u = V + I R both V and I are explicit, so that the point of largest power is
found without solving for I. The functions take and return scalars, so that numba compiles them.
"""

from functools import cache, lru_cache
import math
from typing import Annotated, final, NamedTuple, Self

from lta_config.errors import BadInput
from lta_config.files import StrictModel
from lta_config.schema.cell_file import CellFile, CellRatings, load_cell_file
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_model.light.spectral_factor import spectral_factor
import numpy as np
from pydantic import Field

THERMAL_VOLTAGE = 0.025692579  # V, k T / q at 25 degC
RESISTANCE_STEPS = 200  # of bisection
RESISTANCE_MARGIN = 1e-6  # keeps the equations apart


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
    low, high = (
        0.0,
        (1.0 - RESISTANCE_MARGIN) * (data.open_circuit.si - data.voltage.si) / data.current.si,
    )
    if _slope_at_maximum(data, low) < 0.0:
        raise BadInput(
            f'No diode model with an ideality factor of {data.ideality.si:g} fits the '
            f'solar cell {cell.name}: its current-voltage curve is too square. In the cell '
            'file, lower ideality, or check voltage and current at maximum power.'
        )
    for _ in range(RESISTANCE_STEPS):
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
    """Return the diode through the three points, for a series resistance [ohm]."""
    a = data.ideality.si * data.junctions * THERMAL_VOLTAGE
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
    """Return dP/dV at the maximum of the sheet; it falls as the resistance grows [A]."""
    diode = _solve_three_points(data, resistance)
    junction = data.voltage.si + resistance * data.current.si
    conductance = diode.saturation / diode.thermal * np.exp(junction / diode.thermal) + diode.shunt
    # dI/dV at the terminals: junction conductance in series with the resistance
    slope = conductance / (1.0 + resistance * conductance)
    return data.current.si - data.voltage.si * float(slope)


STANDARD_IRRADIANCE = 1000.0  # W/m2
STANDARD_TEMPERATURE = 298.15  # K
BOLTZMANN = 8.617333262e-5  # eV/K
AIR_TEMPERATURE = 293.15  # K
VOLTAGE_STEPS = 60  # of bisection: more than the bits of a voltage
POSITIVE = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NOT_NEGATIVE = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
# The five parameters of the single-diode equation
Curve = tuple[float, float, float, float, float]  # L, S, a, R, G


@final
class SolarArrayModel(StrictModel):
    """
    All solar cells of a vehicle, in one plane; the values are those of the whole array.

    Attributes
    ----------
    light, saturation : float
        Light current (0 without an array) and saturation current at standard conditions. [A]
    thermal : float
        Ideality times thermal voltage of all junctions in series, at 25 degC. [V]
    series, shunt : float
        Series resistance [ohm] and shunt conductance at standard conditions [S].
    gap : float
        Band gap by ideality. [eV]
    drift : float
        Relative change of the light current with temperature. [1/K]
    warming : float
        Temperature of the cells above that of the air, by irradiance. [K m2/W]

    """

    light: NOT_NEGATIVE
    saturation: NOT_NEGATIVE
    thermal: POSITIVE
    series: NOT_NEGATIVE
    shunt: NOT_NEGATIVE
    gap: POSITIVE = 1.0
    drift: float = 0.0
    warming: NOT_NEGATIVE = 0.0

    @classmethod
    def from_energy(cls, energy: EnergyBlock) -> Self:
        """Return the array of a vehicle file; one that gives nothing if it has none."""
        if energy.array is None:
            return cls(light=0.0, saturation=0.0, thermal=1.0, series=0.0, shunt=0.0)
        array = energy.array
        return cls.from_cell_file(array.cell_file, array.series, array.parallel)

    @classmethod
    def from_cells(cls, cell: str, series: int, parallel: int) -> Self:
        """Return so many strings of so many cells, by the name or path of their file."""
        return cls.from_cell_file(load_cell_file(cell), series, parallel)

    @classmethod
    def from_cell_file(cls, file: CellFile, series: int, parallel: int) -> Self:
        """Return so many strings of so many cells."""
        data, diode = file.electrical, fit_diode(file)
        return cls(
            light=diode.light * parallel,
            saturation=diode.saturation * parallel,
            thermal=diode.thermal * series,
            series=diode.series * series / parallel,
            shunt=diode.shunt * parallel / series,
            gap=data.gap.si / data.ideality.si,
            drift=data.current_drift.si,
            warming=data.warming.si,
        )


@cache
def cell_spectral_factor(cell: str, efficacy: float) -> float:
    """Return the current of a cell by irradiance in a light of some lm/W, relative to sunlight."""
    return spectral_factor(efficacy, load_cell_file(cell).technology)


def array_spectral_factor(energy: EnergyBlock, efficacy: float) -> float:
    """Return `spectral_factor` of the array of a vehicle file; 1 if it has none."""
    if energy.array is None:
        return 1.0
    return spectral_factor(efficacy, energy.array.cell_file.technology)


def compute_curve_parameters(panel: SolarArrayModel, irradiance: float) -> Curve:
    """Return L, S, a, R and G of the curve at an irradiance on the array's plane [W/m2]."""
    # Absolute temperature relative to 25 degC
    warm = (AIR_TEMPERATURE + panel.warming * irradiance) / STANDARD_TEMPERATURE
    kelvin = STANDARD_TEMPERATURE * (warm - 1.0)
    share = irradiance / STANDARD_IRRADIANCE
    # Exponent of the saturation current's temperature dependence
    freed = panel.gap * (1.0 - 1.0 / warm) / (BOLTZMANN * STANDARD_TEMPERATURE)
    return (
        share * panel.light * (1.0 + panel.drift * kelvin),
        panel.saturation * warm**3 * math.exp(freed),
        panel.thermal * warm,
        panel.series,
        panel.shunt * share,
    )


def junction_current(numbers: Curve, u: float) -> float:
    """Return the current of the array at a junction voltage u [V] [A]."""
    light, saturation, a, _, shunt = numbers
    return light - saturation * math.expm1(u / a) - u * shunt


def voltage_bound(numbers: Curve) -> float:
    """Return a junction voltage at which no current is left: above the open circuit's [V]."""
    light, saturation, a, _, _ = numbers
    # The shunt is neglected, so this is above the open-circuit voltage
    return a * math.log1p(light / saturation) if saturation > 0.0 else 0.0


def power_slope(numbers: Curve, u: float) -> float:
    """Return dP/du, positive below the point of largest power [A]."""
    _, saturation, a, resistance, shunt = numbers
    current = junction_current(numbers, u)
    slope = -saturation / a * math.exp(u / a) - shunt
    # d/du of (u - I R) I
    return current + (u - 2.0 * resistance * current) * slope


def find_max_power_point(panel: SolarArrayModel, irradiance: float) -> tuple[float, float]:
    """Return voltage [V] and current [A] of maximum power at an irradiance [W/m2], or zeros."""
    if irradiance <= 0.0 or panel.light <= 0.0:
        return 0.0, 0.0
    numbers = compute_curve_parameters(panel, irradiance)
    low, high = 0.0, voltage_bound(numbers)
    for _ in range(VOLTAGE_STEPS):
        u = 0.5 * (low + high)
        # Below the maximum the power still rises
        if power_slope(numbers, u) > 0.0:
            low = u
        else:
            high = u
    current = junction_current(numbers, low)
    # Terminal voltage: junction voltage less the drop in the series resistance
    return low - numbers[3] * current, current


def current_at_voltage(panel: SolarArrayModel, irradiance: float, voltage: float) -> float:
    """
    Return the current at a terminal voltage [V], 0 in the dark: no current flows back [A].

    The short-circuit current is that at 0 V.
    """
    if irradiance <= 0.0 or panel.light <= 0.0:
        return 0.0
    numbers = compute_curve_parameters(panel, irradiance)
    low, high = 0.0, voltage_bound(numbers)
    for _ in range(VOLTAGE_STEPS):
        u = 0.5 * (low + high)
        if u - numbers[3] * junction_current(numbers, u) < voltage:
            low = u
        else:
            high = u
    # No reverse current: the charger blocks it
    return max(0.0, junction_current(numbers, high))
