"""
Compute the break-even illuminance at which the solar harvest equals the load.

Illuminance alone does not fix the radiant power: a white LED emits about 300 lm per radiant watt
and the sun 110, so the same illuminance from the sun carries 2.7 times the power. A beacon with a
duty cycle of one half carries half the power of a steady lamp.
"""

from collections.abc import Mapping
import math
from typing import Final, NamedTuple

from lta_energy.harvest import HarvestCurve
from lta_energy.irradiance import DARK, PanelIrradiance
from lta_model.electrical.charger import charger_output, ChargerModel

LEAST, MOST = 300.0, 100e3  # lx: from a warehouse to the sun
# 60 halvings of 100 klx leave an interval below the resolution of a double
STEPS = 60  # of bisection


class LightSource(NamedTuple):
    """Luminous efficacy [lm per radiant watt] and duty cycle of a kind of light."""

    efficacy: float
    duty: float
    sun: bool = False


LAMPS: Final[Mapping[str, LightSource]] = {
    # [lm per radiant watt], duty cycle
    'white LED': LightSource(300.0, 1.0),
    'flickering LED': LightSource(300.0, 0.5),
    'sun': LightSource(110.0, 1.0, sun=True),
}


def irradiance_from_lux(lamp: LightSource, lux: float) -> PanelIrradiance:
    """Return the irradiance of a lamp whose illuminance [lx] is given for its on phase."""
    # Flickering light goes into the beacon term, because harvest is averaged over its phases
    if lamp.duty < 1.0:
        return DARK._replace(beacon=lux / lamp.efficacy, duty=lamp.duty)
    if lamp.sun:
        return DARK._replace(sun=lux / lamp.efficacy)
    return DARK._replace(lamps=lux / lamp.efficacy)


def charging_power(
    harvest: HarvestCurve, charger: ChargerModel, lamp: LightSource, lux: float
) -> float:
    """Return the charger's output power at an illuminance. [W]"""
    return charger_output(charger, harvest(irradiance_from_lux(lamp, lux)))


def break_even_illuminance(
    harvest: HarvestCurve, charger: ChargerModel, lamp: LightSource, load: float
) -> float:
    """Return the illuminance at which the charger supplies a load [W]; inf above 100 klx. [lx]"""
    low, high = 0.0, MOST
    if charging_power(harvest, charger, lamp, high) < load:
        return math.inf
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        if charging_power(harvest, charger, lamp, middle) < load:
            low = middle
        else:
            high = middle
    # The upper end, so that the load is certainly covered
    return high
