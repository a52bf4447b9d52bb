"""
A steady field of draughts from vents.

    F = size (sin(x / s) cos(y / s), 0, cos(x / s + 1) sin(y / s + 2))   in the map
"""

import math
from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N', 0.0, 0.0, 10.0, 0.01, 'of a challenge'),
    EffectParameter('s', 'm', 0.0, 0.0, 20.0, 1.0, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the force at the position."""
    size, s = p
    r, (x, y, _) = motion.rotation, motion.position
    # The limit avoids a division by the null value of 0
    wide = max(s, 0.1)
    f = size * math.sin(x / wide) * math.cos(y / wide)
    h = size * math.cos(x / wide + 1.0) * math.sin(y / wide + 2.0)
    return (r[0] * f + r[6] * h, r[1] * f + r[7] * h, r[2] * f + r[8] * h, 0.0, 0.0, 0.0)


KIND: Final = OutsideKind(
    WrenchEffect('draught', PARAMETERS, wrench),
    'draughts from vents',
    {'size': (0.004, 0.01), 's': (0.6, 1.5)},
)
