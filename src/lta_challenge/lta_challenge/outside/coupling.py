"""
A pitch moment in simultaneous forward and vertical flight, in addition to that of potential flow.

    N_y = size u w
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N m s2/m2', 0.0, -10.0, 10.0, 0.01, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the moment."""
    (size,) = p
    v = motion.airspeed
    return (0.0, 0.0, 0.0, 0.0, size * v[0] * v[2], 0.0)


KIND: Final = OutsideKind(
    WrenchEffect('coupling', PARAMETERS, wrench),
    'a pitch moment in simultaneous forward and vertical flight',
    {'size': (-0.02, 0.02)},
)
