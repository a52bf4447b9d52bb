"""
A bent shaft: a force that rotates with it.

    F_y = size T cos phi,   F_z = size T sin phi,   N = r x F,   phi' = f

T is the thrust of the third rotor [N], r = (0, 0.1, -0.4) m.
"""

import math
from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', '1', 0.0, 0.0, 10.0, 0.1, 'of a challenge'),
    EffectParameter('f', 'rad/s', 0.0, 0.0, 100.0, 12.0, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the rotating force."""
    size, f = p  # noqa: RUF059 (the kernel knows parameters by their order)
    y = size * thrust[2] * math.cos(memory[0])
    z = size * thrust[2] * math.sin(memory[0])
    # Moment r x F with r = (0, 0.1, -0.4) m
    return (0.0, y, z, 0.1 * z + 0.4 * y, 0.0, 0.0)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rate of the phase."""
    size, f = p  # noqa: RUF059
    return (f,)


KIND: Final = OutsideKind(
    WrenchEffect('wobble', PARAMETERS, wrench, memory=(('phase', 0.0),), rate=rate),
    'a bent rotor shaft',
    {'size': (0.1, 0.4), 'f': (8.0, 16.0)},
)
