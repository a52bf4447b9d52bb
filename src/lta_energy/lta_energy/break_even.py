"""
At what illuminance a drone lives on light: what an array brings equals what a task draws.

An illuminance says little of the power in it: a white LED has some 300 lm in a radiant watt, the
sun 110, so that the same lux from the sun carry 2.7 times as much; and a beacon that flickers half
of the time brings half of what its brightness would.
"""

from collections.abc import Mapping
import math
from typing import Final, NamedTuple

from lta_energy.harvest import HarvestCurve
from lta_energy.irradiance import DARK, PanelIrradiance
from lta_model.electrical.charger import charger_output, ChargerModel

LEAST, MOST = 300.0, 100e3  # lx: from a warehouse to the sun
STEPS = 60  # of bisection


class LightSource(NamedTuple):
    """A kind of light: lumens a radiant watt, and the part of the time that it is on."""

    efficacy: float
    duty: float


LAMPS: Final[Mapping[str, LightSource]] = {
    'white LED': LightSource(300.0, 1.0),
    'flickering LED': LightSource(300.0, 0.5),
    'sun': LightSource(110.0, 1.0),
}


def irradiance_from_lux(lamp: LightSource, lux: float) -> PanelIrradiance:
    """Return the light of a lamp that gives an illuminance while it is on. [lx]"""
    if lamp.duty < 1.0:
        return DARK._replace(beacon=lux / lamp.efficacy, duty=lamp.duty)
    return DARK._replace(lamps=lux / lamp.efficacy)


def charging_power(
    harvest: HarvestCurve, charger: ChargerModel, lamp: LightSource, lux: float
) -> float:
    """Return what the charger gives in so many lux. [W]"""
    return charger_output(charger, harvest(irradiance_from_lux(lamp, lux)))


def break_even_illuminance(
    harvest: HarvestCurve, charger: ChargerModel, lamp: LightSource, load: float
) -> float:
    """
    Return the illuminance at which the charger gives a load [W]. [lx]

    Returns
    -------
    float
        Infinite where 100 klx are not enough.

    """
    low, high = 0.0, MOST
    if charging_power(harvest, charger, lamp, high) < load:
        return math.inf
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        if charging_power(harvest, charger, lamp, middle) < load:
            low = middle
        else:
            high = middle
    return high
