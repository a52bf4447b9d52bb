"""
What the drone consumes: electronics and rotors.

A turning rotor takes a power that is affine in its thrust. That fits Bitcraze's bench table of
four 7 mm coreless motors with an rmse of 63 mW of all four. `lta_energy.rotor` has the same by
duty and voltage.
"""

from collections.abc import Sequence
from typing import Annotated, final, Self

from lta_config.files import Record
from lta_config.vehicle_energy import Energy
from pydantic import Field

NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


@final
class Loads(Record):
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
    sensing : float
        What looks at the light and finds lamps in it. [W]

    """

    idle: NotNegative
    transmitting: NotNegative
    rotor_offset: NotNegative
    rotor_slope: NotNegative
    sensing: NotNegative = 0.0

    @classmethod
    def of(cls, energy: Energy) -> Self:
        """Return the consumers of a vehicle file."""
        return cls(
            idle=energy.loads.idle.si,
            transmitting=energy.loads.transmitting.si,
            rotor_offset=energy.loads.rotor_idle.si,
            rotor_slope=energy.loads.rotor_power.si,
            sensing=0.0 if energy.loads.sensing is None else energy.loads.sensing.si,
        )


def computing_of(energy: Energy, strategy: str) -> float:
    """Return what a strategy computes with beyond sensing; 0 where the file says nothing. [W]"""
    found = energy.loads.computing.get(strategy)
    return 0.0 if found is None else found.si


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


def demand(
    loads: Loads, thrusts: Sequence[float], transmitting: bool, sensing: bool = False
) -> float:
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
    sensing : bool
        Whether the light is looked at.

    Returns
    -------
    float
        Power. [W]

    """
    rotors, offset, slope = 0.0, loads.rotor_offset, loads.rotor_slope
    for thrust in thrusts:
        rotors += rotor_power(thrust, offset, slope)
    electronics = loads.idle + (loads.transmitting if transmitting else 0.0)
    return electronics + (loads.sensing if sensing else 0.0) + rotors
