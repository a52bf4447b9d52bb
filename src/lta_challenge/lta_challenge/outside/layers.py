"""
Stratified air: lift that changes with height.

    F = size sin(z / s) e_z
"""

import math
from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N', 0.0, 0.0, 10.0, 0.01, 'of a challenge'),
    EffectParameter('s', 'm', 0.0, 0.0, 20.0, 0.3, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the lift of the layer."""
    size, s = p
    r = motion.rotation
    lift = size * math.sin(motion.position[2] / max(s, 0.05))
    return (lift * r[6], lift * r[7], lift * r[8], 0.0, 0.0, 0.0)


KIND: Final = OutsideKind(
    WrenchEffect('layers', PARAMETERS, wrench),
    'stratified air: lift that changes with height',
    {'size': (0.004, 0.01), 's': (0.15, 0.5)},
)
