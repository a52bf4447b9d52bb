"""
A loss of forward thrust with airspeed, which a static bench test does not show.

    F_x = -size (T_3 + T_4) u,   N_y = 0.4 m size (T_3 + T_4) u
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (EffectParameter('size', '1/(m/s)', 0.0, -10.0, 10.0, 0.1, 'of a challenge'),)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the thrust that is lost."""
    (size,) = p
    lost = size * (thrust[2] + thrust[3]) * motion.airspeed[0]
    # The forward rotors are 0.4 m below the hull centre
    return (-lost, 0.0, 0.0, 0.0, 0.4 * lost, 0.0)


KIND: Final = OutsideKind(
    WrenchEffect('inflow', PARAMETERS, wrench),
    'forward thrust that falls with airspeed',
    {'size': (0.04, 0.12)},
)
