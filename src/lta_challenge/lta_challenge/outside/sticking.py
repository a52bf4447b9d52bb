"""
A rotor that sticks at irregular times.

    F_x = -size T,   N = r x F   while sin(1.3 t) + sin(0.71 t + 1) + sin(2.9 t) > 1

T is the thrust of the fourth rotor, r = (0, -0.1, -0.4) m.
"""

import math
from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (EffectParameter('size', '1', 0.0, 0.0, 1.0, 0.3, 'of a challenge'),)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the missing thrust."""
    (size,) = p
    t = memory[0]
    # Incommensurable frequencies, so that the pattern does not repeat within a flight
    sticks = math.sin(1.3 * t) + math.sin(0.71 * t + 1.0) + math.sin(2.9 * t) > 1.0
    x = -size * thrust[3] if sticks else 0.0
    return (x, 0.0, 0.0, 0.0, -0.4 * x, 0.1 * x)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rate of the time, which is 1."""
    (size,) = p  # noqa: RUF059
    return (1.0,)


KIND: Final = OutsideKind(
    WrenchEffect('sticking', PARAMETERS, wrench, memory=(('time', 0.0),), rate=rate),
    'a rotor that sticks at irregular times',
    {'size': (0.2, 0.5)},
)
