# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Maximum power of a solar array under steady and flickering light, and the light that feeds a load.

Solar cells respond within microseconds, far faster than a beacon flickers. The mean power is
therefore the mean of the powers with the lamp on and off, not the power in the mean light.
Neglected: the charger holds one voltage through both phases. All lamps are white LEDs.

At the break-even illuminance the harvest equals the load. Illuminance alone does not fix the
radiant power: a white LED emits 326 lm per radiant watt and the sun 109, by their spectra, so the
same illuminance from the sun carries 3.0 times the power. A beacon with a duty cycle of one half
carries half the power of a steady lamp.
"""

from collections.abc import Mapping
import math
from typing import Final, final, NamedTuple, Self

from lta_config.schema.spectrum_file import luminous_efficacy
from lta_config.schema.vehicle_energy import EnergyBlock
from lta_energy.irradiance import NO_IRRADIANCE, PanelIrradiance
from lta_model.electrical.mppt_charger import charger_output, ChargerModel
from lta_model.electrical.panel import (
    array_spectral_factor,
    cell_spectral_factor,
    find_max_power_point,
    SolarArrayModel,
)
from lta_model.light.spectral_factor import STANDARD_LIGHT
import numpy as np

WHITE_LED: Final = 'white_led'  # spectrum of all lamps
# W/m2; linear interpolation between the points
LOWEST_IRRADIANCE, HIGHEST_IRRADIANCE, TABLE_POINTS = 1e-2, 2000.0, 256


@final
class HarvestCurve:
    """
    Maximum power of a horizontal array, interpolated from a table over irradiance.

    `led_factor`: spectral factor of its cells under a white LED.
    """

    def __init__(self, panel: SolarArrayModel, led_factor: float) -> None:
        self.led_factor = led_factor
        # Geometric spacing resolves the five decades from twilight to noon evenly
        self._light = np.concatenate(
            [[0.0], np.geomspace(LOWEST_IRRADIANCE, HIGHEST_IRRADIANCE, TABLE_POINTS)]
        )
        points = [find_max_power_point(panel, float(light)) for light in self._light]
        self._power = np.array([voltage * current for voltage, current in points])

    def steady_light_power(self, irradiance: float) -> float:
        """Return the maximum power in steady sunlight [W/m2] [W]."""
        return float(np.interp(irradiance, self._light, self._power))

    @classmethod
    def of_energy(cls, energy: EnergyBlock) -> Self:
        """Return the harvest of the array of a vehicle file."""
        return cls(
            SolarArrayModel.from_energy(energy),
            array_spectral_factor(energy, luminous_efficacy(WHITE_LED)),
        )

    @classmethod
    def of_cells(cls, cell: str, series: int, parallel: int) -> Self:
        """Return the harvest of so many strings of so many cells."""
        return cls(
            SolarArrayModel.from_cells(cell, series, parallel),
            cell_spectral_factor(cell, luminous_efficacy(WHITE_LED)),
        )

    def __call__(self, light: PanelIrradiance) -> float:
        """Return the maximum power in a mission's light, averaged over the flicker [W]."""
        always = light.sun + self.led_factor * light.lamps
        if light.beacon <= 0.0:
            return self.steady_light_power(always)
        bright = self.steady_light_power(always + self.led_factor * light.beacon)
        return light.duty * bright + (1.0 - light.duty) * self.steady_light_power(always)


LOWEST_ILLUMINANCE, HIGHEST_ILLUMINANCE = 300.0, 100e3  # lx: from a warehouse to the sun
# 60 halvings of 100 klx leave an interval below the resolution of a double
BISECTIONS = 60  # of bisection


class LightSource(NamedTuple):
    """Spectrum, duty cycle and luminous efficacy of a kind of light."""

    spectrum: str
    duty: float = 1.0
    # Luminous efficacy of another light of this kind, by that of the spectrum [1]
    efficacy_ratio: float = 1.0

    @property
    def efficacy(self) -> float:
        """Luminous flux by radiant flux [lm/W]."""
        return self.efficacy_ratio * luminous_efficacy(self.spectrum)


LAMPS: Final[Mapping[str, LightSource]] = {
    'white LED': LightSource(WHITE_LED),
    'flickering LED': LightSource(WHITE_LED, 0.5),
    'sun': LightSource(STANDARD_LIGHT),
}


def irradiance_from_lux(lamp: LightSource, lux: float) -> PanelIrradiance:
    """Return the irradiance of a lamp whose illuminance [lx] is given for its on phase."""
    # Flickering light goes into the beacon term, because harvest is averaged over its phases
    if lamp.duty < 1.0:
        return NO_IRRADIANCE._replace(beacon=lux / lamp.efficacy, duty=lamp.duty)
    if lamp.spectrum == STANDARD_LIGHT:
        return NO_IRRADIANCE._replace(sun=lux / lamp.efficacy)
    return NO_IRRADIANCE._replace(lamps=lux / lamp.efficacy)


def charging_power(
    harvest: HarvestCurve, charger: ChargerModel, lamp: LightSource, lux: float
) -> float:
    """Return the charger's output power at an illuminance [W]."""
    return charger_output(charger, harvest(irradiance_from_lux(lamp, lux)))


def break_even_illuminance(
    harvest: HarvestCurve, charger: ChargerModel, lamp: LightSource, load: float
) -> float:
    """Return the illuminance at which the charger supplies a load [W]; inf above 100 klx [lx]."""
    low, high = 0.0, HIGHEST_ILLUMINANCE
    if charging_power(harvest, charger, lamp, high) < load:
        return math.inf
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if charging_power(harvest, charger, lamp, middle) < load:
            low = middle
        else:
            high = middle
    # The upper end, so that the load is certainly covered
    return high
