"""
What a solar panel gives: radiant power on its plane times area times one constant efficiency.

A constant efficiency is right to first order only: real cells lose voltage in dim light. A
single-diode model takes the place of `power` later; the charger is taken as lossless till then.
"""

from typing import Annotated, final, Self

from lta_config.files import Record
from lta_config.vehicle_energy import Energy
from pydantic import Field

STANDARD = 1000.0  # W/m2, for which the rated power of a cell stands


@final
class Panel(Record):
    """
    All solar cells of a vehicle, in one plane.

    Attributes
    ----------
    area : float
        Area of all cells. [m2]
    efficiency : float
        Electrical by radiant power. [1]
    voltage : float
        Voltage of the harvesting branch. [V]

    """

    area: Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
    efficiency: Annotated[float, Field(ge=0.0, le=1.0)]
    voltage: Annotated[float, Field(gt=0.0, allow_inf_nan=False)]

    @classmethod
    def of(cls, energy: Energy) -> Self:
        """Return the panel of a vehicle file."""
        array = energy.array
        if array is None:
            return cls(area=0.0, efficiency=0.0, voltage=1.0)
        cell = array.cell_file
        return cls(
            area=array.series * array.parallel * cell.area,
            efficiency=cell.rated / (STANDARD * cell.area),
            voltage=array.series * cell.electrical.voltage.si,
        )


def power(irradiance: float, area: float, efficiency: float) -> float:
    """
    Return the electrical power of a panel.

    Parameters
    ----------
    irradiance : float
        Radiant power on the panel's plane by area. [W/m2]
    area : float
        Area of the cells. [m2]
    efficiency : float
        Electrical by radiant power. [1]

    Returns
    -------
    float
        Power, never negative. [W]

    """
    return max(0.0, irradiance) * area * efficiency
