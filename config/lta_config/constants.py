# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Physical constants, and factors of units, that more than one package needs."""

import math

RADIANS_PER_DEGREE = math.pi / 180.0
DEGREES_PER_RADIAN = 180.0 / math.pi
STANDARD_GRAVITY = 9.80665  # m/s2 (CGPM 1901)

# The air that a model is built with; the three numbers belong together
AIR_DENSITY = 1.2041  # kg/m3, dry, at 20 C and 1013.25 hPa
AIR_TEMPERATURE = 293.15  # K
AIR_PRESSURE = 101325.0  # Pa, one standard atmosphere

HELIUM_DENSITY = 0.1664  # kg/m3, at the temperature and pressure of the air
HELIUM_TO_AIR = HELIUM_DENSITY / AIR_DENSITY  # at one temperature and pressure
