"""
Power of the consumers: electronics and rotors.

The power of a turning rotor is affine in its thrust. That fits Bitcraze's bench table of four 7 mm
coreless motors with an rmse of 63 mW for all four. `lta_energy.rotor` has it by duty and voltage.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, final, Self

from lta_config.files import StrictModel
from lta_config.schema.vehicle_energy import EnergyBlock
from pydantic import Field

NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


@final
class LoadModel(StrictModel):
    """
    Power of each consumer.

    Attributes `idle`, `transmitting`: electronics without radio, and addition while the radio
    sends [W]. Attributes `rotor_offset`, `rotor_slope`: a turning rotor at vanishing thrust [W],
    and its power by thrust [W/N].
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
    Return the power of sensing and computing for a navigation strategy, '' for none. [W]

    Entries missing in the file count as 0. A strategy from a file ./mine.py is called `mine`.
    """
    powers = (energy.loads.sensing, energy.loads.computing.get(Path(strategy).stem))
    return sum(power.si for power in powers if power is not None) if strategy else 0.0


def rotor_power(thrust: float, offset: float, slope: float) -> float:
    """
    Return the electrical power of one rotor [W] at a thrust of either sign [N].

    At exactly 0 the rotor is off and takes nothing.
    """
    return offset + slope * abs(thrust) if thrust != 0.0 else 0.0


def power_demand(loads: LoadModel, thrusts: Sequence[float], transmitting: bool) -> float:
    """Return the power of the whole drone [W] at the thrust of each rotor [N]."""
    rotors, offset, slope = 0.0, loads.rotor_offset, loads.rotor_slope
    for thrust in thrusts:
        rotors += rotor_power(thrust, offset, slope)
    return loads.idle + (loads.transmitting if transmitting else 0.0) + rotors
