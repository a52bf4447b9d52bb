"""
A rope that hangs from the gondola and drags over the floor.

    F_z = -size h,   F_h = -rubbing size max(0, length - h) v / sqrt(v^2 + v_s^2)

at the gondola, h its height: what hangs is carried, what lies rubs. Its weight at the usual height
is trimmed away.
"""

import math
from typing import Final

from lta_sim.effects.protocol import Motion, Parameter, Values, Wrench, WrenchEffect

PARAMETERS: Final = (
    Parameter('size', 'N/m', 0.0, 0.0, 10.0, 0.01, 'of a challenge'),
    Parameter('length', 'm', 0.0, 0.0, 20.0, 1.0, 'of a challenge'),
    Parameter('rubbing', '1', 0.0, 0.0, 5.0, 0.5, 'of a challenge'),
)
DEEP: Final = 0.4  # m; of the gondola below the hull centre
USUAL: Final = 1.5  # m; height of the hull centre at which it is trimmed
SLIP: Final = 0.05  # m/s


def wrench(p: Values, memory: Values, motion: Motion, thrust: Values) -> Wrench:
    """Return pull and rub of the rope."""
    size, length, rubbing = p
    r, v, w = motion.rotation, motion.velocity, motion.rates
    height = motion.position[2] - DEEP * r[8]
    a, b, c = v[0] - DEEP * w[1], v[1] + DEEP * w[0], v[2]
    east, north = r[0] * a + r[1] * b + r[2] * c, r[3] * a + r[4] * b + r[5] * c
    grip = -rubbing * size * max(0.0, length - height)
    grip /= math.sqrt(east * east + north * north + SLIP * SLIP)
    f, g, h = grip * east, grip * north, -size * (height - (USUAL - DEEP))
    x = r[0] * f + r[3] * g + r[6] * h
    y = r[1] * f + r[4] * g + r[7] * h
    z = r[2] * f + r[5] * g + r[8] * h
    return (x, y, z, DEEP * y, -DEEP * x, 0.0)


EFFECT: Final = WrenchEffect('tether', PARAMETERS, wrench)
