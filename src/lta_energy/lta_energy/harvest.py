"""
Compute the maximum power of a solar array under steady and flickering light.

Solar cells respond within microseconds, far faster than a beacon flickers. The mean power is
therefore the mean of the powers with the lamp on and off, not the power in the mean light.
Neglected: the charger holds one voltage through both phases.
"""

from typing import final

from lta_energy.irradiance import PanelIrradiance
from lta_model.electrical.panel import find_max_power_point, SolarArrayModel
import numpy as np

LEAST, MOST, POINTS = 1e-2, 2000.0, 256  # W/m2; linear interpolation between the points


@final
class HarvestCurve:
    """Maximum power of a horizontal array, interpolated from a table over irradiance."""

    def __init__(self, panel: SolarArrayModel) -> None:
        # Geometric spacing resolves the five decades from twilight to noon evenly
        self._light = np.concatenate([[0.0], np.geomspace(LEAST, MOST, POINTS)])
        points = [find_max_power_point(panel, float(light)) for light in self._light]
        self._power = np.array([voltage * current for voltage, current in points])

    def steady_light_power(self, irradiance: float) -> float:
        """Return the maximum power in steady light [W/m2]. [W]"""
        return float(np.interp(irradiance, self._light, self._power))

    def __call__(self, light: PanelIrradiance) -> float:
        """Return the maximum power in a mission's light, averaged over the flicker. [W]"""
        always = light.sun + light.lamps
        if light.beacon <= 0.0:
            return self.steady_light_power(always)
        bright = self.steady_light_power(always + light.beacon)
        return light.duty * bright + (1.0 - light.duty) * self.steady_light_power(always)
