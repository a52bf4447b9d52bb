"""
An electrically charged hull between metal curtains, attracted by its image charge.

    F = size q^2 s / (d^2 + (0.5 m)^2)^1.5 along the normal of the curtains
    q' = (1 - q) |v| / 5 m - q / leak

There is a curtain every 5 m. Near one, s and d are the distance to it; half-way s is 0, since both
pull equally: s = 5 m sin(2 a) / (2 pi), d = 5 m sin(a) / pi with a the distance divided by
5 m / pi. v is the velocity through the air. A charge of 1 uC has a size of
(1 uC)^2 / (16 pi eps_0) = 2.2 mN m2.
"""

import math
from typing import Final

from lta_challenge.outside.shared.axes import rotate_to_body
from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N m2', 0.0, 0.0, 0.1, 0.02, 'of a challenge'),
    EffectParameter('leak', 's', 0.0, 0.0, 1e4, 30.0, 'of a challenge'),
    EffectParameter('normal', 'rad', 0.0, -4.0, 4.0, 1.0, 'of a challenge'),
    EffectParameter('away', 'm', 0.0, -20.0, 20.0, 1.0, 'of a challenge'),
)
APART: Final = 5.0  # m; distance between curtains
WIDE: Final = 0.5  # m; the charge is spread over the hull
RUBBED: Final = 5.0  # m; distance flown through the air to charge the hull to 1 - 1/e


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the pull of the curtains."""
    size, leak, normal, away = p  # noqa: RUF059 (the kernel knows parameters by their order)
    x, y = math.cos(normal), math.sin(normal)
    # Phase of the periodic arrangement of curtains
    a = (away - x * motion.position[0] - y * motion.position[1]) * math.pi / APART
    s, d = APART * math.sin(2.0 * a) / (2.0 * math.pi), APART * math.sin(a) / math.pi
    pull = size * memory[0] * memory[0] * s / (d * d + WIDE * WIDE) ** 1.5
    f, g, h = rotate_to_body(motion.rotation, pull * x, pull * y, 0.0)
    return (f, g, h, 0.0, 0.0, 0.0)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rate of the charge."""
    size, leak, normal, away = p  # noqa: RUF059
    v = motion.airspeed
    speed = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    # The limit avoids a division by the null value of 0
    return ((1.0 - memory[0]) * speed / RUBBED - memory[0] / max(leak, 1.0),)


KIND: Final = OutsideKind(
    WrenchEffect('charged', PARAMETERS, wrench, memory=(('charge', 0.5),), rate=rate),
    'an electrically charged hull between metal curtains',
    {'size': (0.01, 0.04), 'leak': (10.0, 60.0), 'normal': (-3.1, 3.1), 'away': (0.5, 2.5)},
    late=True,
)
