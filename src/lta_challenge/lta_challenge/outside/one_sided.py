"""
A flap that opens in one direction only: it damps turns to the left but not to the right.

    N_z = -size max(0, r)^2,   F_y = lever size max(0, v)^2   with r the yaw rate, v the sway speed
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N m s2', 0.0, 0.0, 10.0, 0.002, 'of a challenge'),
    EffectParameter('lever', '1/m', 0.0, -10.0, 10.0, 1.0, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the drag of the flap."""
    size, lever = p
    turn, slip = max(0.0, motion.rates[2]), max(0.0, motion.airspeed[1])
    return (0.0, -lever * size * slip * slip, 0.0, 0.0, 0.0, -size * turn * turn)


KIND: Final = OutsideKind(
    WrenchEffect('one_sided', PARAMETERS, wrench),
    'a flap that opens in one direction only',
    {'size': (0.002, 0.006), 'lever': (2.0, 10.0)},
)
