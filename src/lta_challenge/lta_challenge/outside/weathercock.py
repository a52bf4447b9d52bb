"""
A hull with weathercock stability: it turns into the airflow.

    N_z = size v |v_h|,   v the sway speed, v_h the horizontal velocity through the air
"""

import math
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
    speed = math.sqrt(v[0] * v[0] + v[1] * v[1])
    return (0.0, 0.0, 0.0, 0.0, 0.0, size * v[1] * speed)


KIND: Final = OutsideKind(
    WrenchEffect('weathercock', PARAMETERS, wrench),
    'a hull that turns into the airflow',
    {'size': (-0.01, 0.01)},
)
