"""
What a solar array can give: the single-diode model.

    I = L - S (exp((V + I R) / a) - 1) - (V + I R) G

Light current L and shunt conductance G go with the irradiance (De Soto, Klein and Beckman 2006).
Irradiance is that of sunlight: other light is multiplied by its spectral factor before. Further,
a with the absolute temperature T, S with T^3 exp(-gap / (ideality k T)) (as in PVsyst); R stays.
`lta_model.electrical.diode_fit` derives the numbers from a data sheet. All junctions of an
array are alike and see the same light.

At a junction voltage u = V + I R both V and I are explicit, so that the point of largest power is
found without solving for I. The functions take and return scalars, so that numba compiles them.
"""

from functools import cache
import math
from typing import Annotated, final, Self

from lta_config.files import StrictModel
from lta_config.schema.cell_file import CellFile, load_cell_file
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_model.electrical.diode_fit import fit_diode
from lta_model.light.spectral_factor import spectral_factor
from pydantic import Field

STANDARD_IRRADIANCE = 1000.0  # W/m2
STANDARD_TEMPERATURE = 298.15  # K
BOLTZMANN = 8.617333262e-5  # eV/K
AIR_TEMPERATURE = 293.15  # K
STEPS = 60  # of bisection: more than the bits of a voltage
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
    """Return L, S, a, R and G of the curve at an irradiance on the array's plane. [W/m2]"""
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
    """Return the current of the array at a junction voltage u [V]. [A]"""
    light, saturation, a, _, shunt = numbers
    return light - saturation * math.expm1(u / a) - u * shunt


def voltage_bound(numbers: Curve) -> float:
    """Return a junction voltage at which no current is left: above the open circuit's. [V]"""
    light, saturation, a, _, _ = numbers
    # The shunt is neglected, so this is above the open-circuit voltage
    return a * math.log1p(light / saturation) if saturation > 0.0 else 0.0


def power_slope(numbers: Curve, u: float) -> float:
    """Return dP/du, positive below the point of largest power. [A]"""
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
    for _ in range(STEPS):
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
    Return the current at a terminal voltage [V], 0 in the dark: no current flows back. [A]

    The short-circuit current is that at 0 V.
    """
    if irradiance <= 0.0 or panel.light <= 0.0:
        return 0.0
    numbers = compute_curve_parameters(panel, irradiance)
    low, high = 0.0, voltage_bound(numbers)
    for _ in range(STEPS):
        u = 0.5 * (low + high)
        if u - numbers[3] * junction_current(numbers, u) < voltage:
            low = u
        else:
            high = u
    # No reverse current: the charger blocks it
    return max(0.0, junction_current(numbers, high))
