"""
Compute the maximum power of a solar array under steady and flickering light.

Solar cells respond within microseconds, far faster than a beacon flickers. The mean power is
therefore the mean of the powers with the lamp on and off, not the power in the mean light.
Neglected: the charger holds one voltage through both phases. All lamps are white LEDs.
"""

from typing import final, Self

from lta_config.schema.vehicle_energy import EnergyBlock
from lta_energy.irradiance import PanelIrradiance
from lta_model.electrical.panel import (
    array_spectral_factor,
    cell_spectral_factor,
    find_max_power_point,
    SolarArrayModel,
)
import numpy as np

WHITE_LED = 300.0  # lm/W, of the lamps of a day
LEAST, MOST, POINTS = 1e-2, 2000.0, 256  # W/m2; linear interpolation between the points


@final
class HarvestCurve:
    """
    Maximum power of a horizontal array, interpolated from a table over irradiance.

    `led_factor`: spectral factor of its cells under a white LED.
    """

    def __init__(self, panel: SolarArrayModel, led_factor: float) -> None:
        self.led_factor = led_factor
        # Geometric spacing resolves the five decades from twilight to noon evenly
        self._light = np.concatenate([[0.0], np.geomspace(LEAST, MOST, POINTS)])
        points = [find_max_power_point(panel, float(light)) for light in self._light]
        self._power = np.array([voltage * current for voltage, current in points])

    def steady_light_power(self, irradiance: float) -> float:
        """Return the maximum power in steady sunlight [W/m2]. [W]"""
        return float(np.interp(irradiance, self._light, self._power))

    @classmethod
    def of_energy(cls, energy: EnergyBlock) -> Self:
        """Return the harvest of the array of a vehicle file."""
        return cls(SolarArrayModel.from_energy(energy), array_spectral_factor(energy, WHITE_LED))

    @classmethod
    def of_cells(cls, cell: str, series: int, parallel: int) -> Self:
        """Return the harvest of so many strings of so many cells."""
        return cls(
            SolarArrayModel.from_cells(cell, series, parallel),
            cell_spectral_factor(cell, WHITE_LED),
        )

    def __call__(self, light: PanelIrradiance) -> float:
        """Return the maximum power in a mission's light, averaged over the flicker. [W]"""
        always = light.sun + self.led_factor * light.lamps
        if light.beacon <= 0.0:
            return self.steady_light_power(always)
        bright = self.steady_light_power(always + self.led_factor * light.beacon)
        return light.duty * bright + (1.0 - light.duty) * self.steady_light_power(always)
