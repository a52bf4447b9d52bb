"""
A rope that hangs from the gondola and drags over the floor.

    F_z = -size h,   F_h = -rubbing size max(0, length - h) v / sqrt(v^2 + v_s^2)

at the gondola with its height h: the hanging part adds weight, the part on the floor friction. Its
weight at the usual height is trimmed.
"""

import math
from typing import Final

from lta_challenge.outside.shared.axes import horizontal_components, rotate_to_body
from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N/m', 0.0, 0.0, 10.0, 0.01, 'of a challenge'),
    EffectParameter('length', 'm', 0.0, 0.0, 20.0, 1.0, 'of a challenge'),
    EffectParameter('rubbing', '1', 0.0, 0.0, 5.0, 0.5, 'of a challenge'),
)
DEEP: Final = 0.4  # m; of the gondola below the hull centre
USUAL: Final = 1.5  # m; height of the hull centre at which it is trimmed
SLIP: Final = 0.05  # m/s; smooths the friction near rest


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return weight and friction of the rope."""
    size, length, rubbing = p
    r, v, w = motion.rotation, motion.velocity, motion.rates
    height = motion.position[2] - DEEP * r[8]
    a, b, c = v[0] - DEEP * w[1], v[1] + DEEP * w[0], v[2]
    east, north = horizontal_components(r, a, b, c)
    grip = -rubbing * size * max(0.0, length - height)
    # Coulomb friction, smoothed near rest
    grip /= math.sqrt(east * east + north * north + SLIP * SLIP)
    f, g, h = grip * east, grip * north, -size * (height - (USUAL - DEEP))
    x, y, z = rotate_to_body(r, f, g, h)
    return (x, y, z, DEEP * y, -DEEP * x, 0.0)


KIND: Final = OutsideKind(
    WrenchEffect('tether', PARAMETERS, wrench),
    'a rope that drags over the floor',
    {'size': (0.004, 0.01), 'length': (2.0, 4.0), 'rubbing': (0.3, 0.8)},
)
