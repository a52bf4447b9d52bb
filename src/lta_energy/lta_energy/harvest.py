"""
What an array can give in the light of a mission, flicker included.

A beacon that flickers some hundred times a second lights the array for part of the time. Cells
answer in microseconds, so that the power is the mean of that with the lamp on and that without,
not that of the mean light. Left out: that the charger holds one voltage through both.
"""

from typing import final

from lta_energy.irradiance import PanelIrradiance
from lta_model.electrical.panel import find_max_power, SolarArrayModel
import numpy as np

LEAST, MOST, POINTS = 1e-2, 2000.0, 256  # W/m2; between points the power is a straight line


@final
class HarvestCurve:
    """
    The largest power of a level array, looked up: 256 points from twilight to noon.

    Parameters
    ----------
    panel : Panel
        The array.

    """

    def __init__(self, panel: SolarArrayModel) -> None:
        self._light = np.concatenate([[0.0], np.geomspace(LEAST, MOST, POINTS)])
        points = [find_max_power(panel, float(light)) for light in self._light]
        self._power = np.array([voltage * current for voltage, current in points])

    def steady_power(self, irradiance: float) -> float:
        """Return the power in steady light of so many W/m2. [W]"""
        return float(np.interp(irradiance, self._light, self._power))

    def __call__(self, light: PanelIrradiance) -> float:
        """Return the power in the light of a mission. [W]"""
        always = light.sun + light.lamps
        if light.beacon <= 0.0:
            return self.steady_power(always)
        bright = self.steady_power(always + light.beacon)
        return light.duty * bright + (1.0 - light.duty) * self.steady_power(always)
