"""
A slack nose that the air dents above an airspeed: drag that sets in.

    F_x = -size (u^2 - onset^2)   where u > onset,   u the forward speed through the air

A hull keeps its shape up to the dynamic pressure that equals the pressure of its gas, and so
airships hold theirs above that of their top speed (Khoury, Airship Technology). Beyond, the dent
deepens with the excess of pressure, and size is half the air density times the added drag area.
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N s2/m2', 0.0, 0.0, 1.0, 0.03, 'of a challenge'),
    EffectParameter('onset', 'm/s', 0.0, 0.0, 20.0, 0.1, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the drag of the dent."""
    size, onset = p
    u = max(motion.airspeed[0], onset)
    return (-size * (u * u - onset * onset), 0.0, 0.0, 0.0, 0.0, 0.0)


KIND: Final = OutsideKind(
    WrenchEffect('dented_nose', PARAMETERS, wrench),
    'a nose that the air dents above an airspeed',
    {'size': (0.03, 0.15), 'onset': (0.15, 0.35)},
    late=True,
)
