"""
A wet hull that dries in the airflow: extra weight that decays.

    F = -size m e_z,   m' = -m (1 + |v| / 0.3 m/s) / takes,   m = 1 at first

v is the velocity through the air. The vehicle is trimmed dry.
"""

import math
from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N', 0.0, 0.0, 0.06, 0.01, 'of a challenge'),
    EffectParameter('takes', 's', 0.0, 0.0, 1e4, 60.0, 'of a challenge'),
)
WINDY: Final = 0.3  # m/s; airspeed that doubles the drying rate


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the weight of the water."""
    size, takes = p  # noqa: RUF059 (the kernel knows parameters by their order)
    r = motion.rotation
    lift = -size * memory[0]
    return (lift * r[6], lift * r[7], lift * r[8], 0.0, 0.0, 0.0)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rate of the water."""
    size, takes = p  # noqa: RUF059
    v = motion.airspeed
    speed = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    return (-memory[0] * (1.0 + speed / WINDY) / max(takes, 1.0),)


KIND: Final = OutsideKind(
    WrenchEffect('drying', PARAMETERS, wrench, memory=(('water', 1.0),), rate=rate),
    'a wet hull that dries',
    {'size': (0.01, 0.03), 'takes': (30.0, 90.0)},
    late=True,
)
