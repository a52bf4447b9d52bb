"""
A gondola on springs with its own oscillation in pitch and roll.

    N = size (f^2 (a - angle) + 2 damping f (a' - rate)),   a'' = -N / size

for pitch and for roll; `size` is its inertia, a its angle.
"""

import math
from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'kg m2', 0.0, 0.0, 1.0, 0.003, 'of a challenge'),
    EffectParameter('f', 'rad/s', 0.0, 0.0, 50.0, 5.0, 'of a challenge'),
    EffectParameter('damping', '1', 0.0, 0.0, 1.0, 0.1, 'of a challenge'),
)


def spring_moments(p: Values, memory: Values, motion: VehicleMotion) -> tuple[float, float]:
    """Return the moments in roll and pitch, divided by the inertia."""
    size, f, damping = p  # noqa: RUF059 (the kernel knows parameters by their order)
    r, w = motion.rotation, motion.rates
    # Tait-Bryan angles from the last row of R; clipped against rounding
    pitch, roll = math.asin(min(1.0, max(-1.0, -r[6]))), math.atan2(r[7], r[8])
    x = f * f * (memory[0] - roll) + 2.0 * damping * f * (memory[1] - w[0])
    y = f * f * (memory[2] - pitch) + 2.0 * damping * f * (memory[3] - w[1])
    return (x, y)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the moment of the springs."""
    size, f, damping = p
    x, y = spring_moments((size, f, damping), memory, motion)
    return (0.0, 0.0, 0.0, size * x, size * y, 0.0)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rates of the gondola's angles."""
    size, f, damping = p
    x, y = spring_moments((size, f, damping), memory, motion)
    return (memory[1], -x, memory[3], -y)


KIND: Final = OutsideKind(
    WrenchEffect(
        'gondola',
        PARAMETERS,
        wrench,
        memory=(('roll', 0.0), ('p', 0.0), ('pitch', 0.0), ('q', 0.0)),
        rate=rate,
    ),
    'a gondola that oscillates on springs',
    {'size': (0.002, 0.006), 'f': (4.0, 9.0), 'damping': (0.03, 0.15)},
)
