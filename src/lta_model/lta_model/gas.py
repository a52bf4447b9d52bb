"""
The air that a model is built with, and helium in it.

The three numbers of the air belong together: `lta_config.constants.AIR_DENSITY` is that of dry air
at this temperature and pressure.
"""

from lta_config.constants import AIR_DENSITY

AIR_TEMPERATURE = 293.15  # K
AIR_PRESSURE = 101325.0  # Pa, one standard atmosphere
HELIUM_DENSITY = 0.1664  # kg/m3, at the temperature and pressure of the air
HELIUM_TO_AIR = HELIUM_DENSITY / AIR_DENSITY  # at one temperature and pressure
