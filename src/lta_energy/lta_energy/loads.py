"""
What the drone consumes: electronics and rotors.

Electronics: the paper's 97 mW idle and 120 mW transmitting. Rotors: 27 mW and 23.96 W/N each above
idle, fitted to Bitcraze's bench table of four 7 mm coreless motors (rmse 63 mW of four).
"""

from collections.abc import Sequence
from typing import final

from lta_config.settings import setting, Settings


@final
class LoadSettings(Settings):
    """Power of each consumer."""

    idle: float = setting(0.097, 'Electronics without radio.', unit='W', low=0.0, high=100.0)
    transmitting: float = setting(
        0.023, 'What the radio adds while it sends.', unit='W', low=0.0, high=100.0
    )
    rotor_offset: float = setting(
        0.027, 'A turning rotor at vanishing thrust.', unit='W', low=0.0, high=100.0
    )
    rotor_slope: float = setting(23.96, 'Rotor power by thrust.', unit='W/N', low=0.0, high=1000.0)


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


def demand(settings: LoadSettings, thrusts: Sequence[float], transmitting: bool) -> float:
    """
    Return the power that the whole drone draws.

    Parameters
    ----------
    settings : LoadSettings
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
    rotors = sum(
        rotor_power(thrust, settings.rotor_offset, settings.rotor_slope) for thrust in thrusts
    )
    return settings.idle + (settings.transmitting if transmitting else 0.0) + rotors
