"""
What a solar panel gives: light on its plane times area times one constant efficiency.

A constant efficiency is right to first order only: real cells lose voltage in dim light. A
single-diode model takes the place of `power` later; the charger is taken as lossless till then.
"""

from typing import final

from lta_config.settings import setting, Settings


@final
class PanelSettings(Settings):
    """Two ANYSOLAR SM811K08L of 89 x 78 mm."""

    area: float = setting(0.01388, 'Area of all cells.', unit='m2', low=0.0, high=10.0)
    efficiency: float = setting(0.20, 'Electrical by radiant power, assumed.', low=0.0, high=1.0)
    efficacy: float = setting(
        300.0, 'Lumens a radiant watt: white LED 300, sun 105.', unit='lm/W', low=1.0, high=683.0
    )
    voltage: float = setting(
        4.4, 'Voltage of the harvesting branch, assumed constant.', unit='V', low=0.1, high=60.0
    )


def irradiance(illuminance: float, efficacy: float) -> float:
    """Return radiant power by area [W/m^2] for an illuminance [lx] and efficacy [lm/W]."""
    return illuminance / efficacy


def power(illuminance: float, efficacy: float, area: float, efficiency: float) -> float:
    """
    Return the electrical power of a panel.

    Parameters
    ----------
    illuminance : float
        Light on the panel's plane. [lx]
    efficacy : float
        Lumens of the light by radiant watt. [lm/W]
    area : float
        Area of the cells. [m^2]
    efficiency : float
        Electrical by radiant power. [1]

    Returns
    -------
    float
        Power, never negative. [W]

    """
    return max(0.0, irradiance(illuminance, efficacy)) * area * efficiency
