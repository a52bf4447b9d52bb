"""
A fin in the rotor jet: its moment is proportional to thrust times speed.

    N_z = size (T_3 + T_4) u,   N_y = -size (T_3 + T_4) w
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (EffectParameter('size', 'm/(m/s)', 0.0, -10.0, 10.0, 0.02, 'of a challenge'),)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the moment of the fin."""
    (size,) = p
    v = motion.airspeed
    # Rotors 3 and 4 are the forward rotors
    jet = size * (thrust[2] + thrust[3])
    return (0.0, 0.0, 0.0, 0.0, -jet * v[2], jet * v[0])


KIND: Final = OutsideKind(
    WrenchEffect('blown_fin', PARAMETERS, wrench),
    'a fin in the rotor jet',
    {'size': (0.03, 0.1)},
)
