"""Physical constants that more than one package needs."""

STANDARD_GRAVITY = 9.80665  # m/s2 (CGPM 1901)
AIR_DENSITY = 1.2041  # kg/m3, dry, at 20 C and 1013.25 hPa
