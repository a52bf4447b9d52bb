"""
What the drone consumes: electronics and rotors.

A turning rotor takes a power that is affine in its thrust. That fits Bitcraze's bench table of
four 7 mm coreless motors with an rmse of 63 mW of all four. `lta_energy.rotor` has the same by
duty and voltage.
"""

from collections.abc import Sequence
from typing import Annotated, final, Self

from lta_config.files import StrictModel
from lta_config.schema.vehicle_energy import EnergyBlock
from pydantic import Field

NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


@final
class LoadModel(StrictModel):
    """
    Power of each consumer.

    Attributes
    ----------
    idle : float
        Electronics without radio. [W]
    transmitting : float
        What the radio adds while it sends. [W]
    rotor_offset : float
        A turning rotor at vanishing thrust. [W]
    rotor_slope : float
        Rotor power by thrust. [W/N]

    """

    idle: NotNegative
    transmitting: NotNegative
    rotor_offset: NotNegative
    rotor_slope: NotNegative

    @classmethod
    def from_energy(cls, energy: EnergyBlock) -> Self:
        """Return the consumers of a vehicle file."""
        return cls(
            idle=energy.loads.idle.si,
            transmitting=energy.loads.transmitting.si,
            rotor_offset=energy.loads.rotor_idle.si,
            rotor_slope=energy.loads.rotor_power.si,
        )


def navigation_power(energy: EnergyBlock, strategy: str) -> float:
    """
    Return what finding lamps takes beside controller and radio: sensing and computing. [W]

    Parameters
    ----------
    energy : Energy
        Of the vehicle's file; what it does not say takes nothing.
    strategy : str
        Navigation strategy by name; '' where nobody looks.

    """
    given = (energy.loads.sensing, energy.loads.computing.get(strategy))
    return sum(power.si for power in given if power is not None) if strategy else 0.0


def rotor_power(thrust: float, offset: float, slope: float) -> float:
    """
    Return the electrical power of one rotor.

    Parameters
    ----------
    thrust : float
        Thrust of either sign; at exactly 0 the rotor stands still and takes nothing. [N]
    offset : float
        Power of a turning rotor at vanishing thrust. [W]
    slope : float
        Power by thrust. [W/N]

    Returns
    -------
    float
        Power. [W]

    """
    return offset + slope * abs(thrust) if thrust != 0.0 else 0.0


def power_demand(loads: LoadModel, thrusts: Sequence[float], transmitting: bool) -> float:
    """
    Return the power that the whole drone draws.

    Parameters
    ----------
    loads : Loads
        Power of each consumer.
    thrusts : sequence of float
        Thrust of each rotor. [N]
    transmitting : bool
        Whether the radio sends.

    Returns
    -------
    float
        Power. [W]

    """
    rotors, offset, slope = 0.0, loads.rotor_offset, loads.rotor_slope
    for thrust in thrusts:
        rotors += rotor_power(thrust, offset, slope)
    return loads.idle + (loads.transmitting if transmitting else 0.0) + rotors
