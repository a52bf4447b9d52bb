"""
Warm air that rises over patches of a warm floor, with inflow near the floor.

    F_z = size (q - 0.2),   F_h = size exp(-z / 1 m) grad q wide / 2
    q = exp((cos k x + cos k y - 2) / (k wide)^2),   k = 2 pi / 4 m

in the map, x and y from the centre of a patch: near it q is exp(-r^2 / (2 wide^2)). There is a
patch every 4 m, and air sinks between them.
"""

import math
from typing import Final

from lta_challenge.outside.shared.axes import rotate_to_body
from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N', 0.0, 0.0, 0.025, 0.01, 'of a challenge'),
    EffectParameter('wide', 'm', 0.0, 0.0, 20.0, 0.6, 'of a challenge'),
    EffectParameter('east', 'm', 0.0, -20.0, 20.0, 1.0, 'of a challenge'),
    EffectParameter('north', 'm', 0.0, -20.0, 20.0, 1.0, 'of a challenge'),
)
APART: Final = 4.0  # m; distance between patches
SINKS: Final = 0.2  # sinking between the patches, relative to the rise
HIGH: Final = 1.0  # m; decay height of the inflow


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the force of the warm air."""
    size, wide, east, north = p
    k = 2.0 * math.pi / APART
    x, y = k * (motion.position[0] - east), k * (motion.position[1] - north)
    spread = k * max(wide, 0.1)
    warm = size * math.exp((math.cos(x) + math.cos(y) - 2.0) / (spread * spread))
    inward = 0.5 * warm * math.exp(-motion.position[2] / HIGH) / spread
    f, g = -inward * math.sin(x), -inward * math.sin(y)
    a, b, c = rotate_to_body(motion.rotation, f, g, warm - SINKS * size)
    return (a, b, c, 0.0, 0.0, 0.0)


KIND: Final = OutsideKind(
    WrenchEffect('plume', PARAMETERS, wrench),
    'warm air that rises over patches of the floor',
    {'size': (0.005, 0.02), 'wide': (0.4, 0.8), 'east': (-1.5, 1.5), 'north': (-1.5, 1.5)},
    late=True,
)
