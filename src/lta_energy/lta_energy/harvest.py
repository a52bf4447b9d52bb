"""
What a panel brings from the light of a mission, flicker included.

A beacon that flickers some hundred times a second lights the panel for part of the time. Cells
answer in microseconds, so that the harvest is the mean of that with the lamp on and that without,
not that of the mean light.
"""

from lta_energy.light_of_days import Light
from lta_energy.panel import Panel, power


def harvest(panel: Panel, light: Light) -> float:
    """Return what a level panel brings. [W]"""
    always = light.sun + light.lamps
    with_beacon = power(always + light.beacon, panel.area, panel.efficiency)
    without = power(always, panel.area, panel.efficiency)
    return light.duty * with_beacon + (1.0 - light.duty) * without
