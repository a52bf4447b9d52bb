"""
Lifting rotors that enter the vortex ring state in descent and recover slowly.

    F_z = -size (T_1 + T_2) c,   c = (1 + a) / 2 within 0 and 1
    a' = (a - a^3 + 0.385 (-w - middle) / half) / 0.15 s

w is the velocity through the air along the body's upward axis. They stall at a sink rate above
middle + half and recover below middle - half (hysteresis).
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', '1', 0.0, 0.0, 1.0, 0.3, 'of a challenge'),
    EffectParameter('middle', 'm/s', 0.0, 0.0, 5.0, 0.04, 'of a challenge'),
    EffectParameter('half', 'm/s', 0.0, 0.0, 5.0, 0.02, 'of a challenge'),
)
FOLD: Final = 0.3849  # 2 / (3 sqrt 3)
TAKES: Final = 0.15  # s; time scale of the transition


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the lost thrust."""
    size, middle, half = p  # noqa: RUF059 (the kernel knows parameters by their order)
    stalled = min(max(0.5 * (1.0 + memory[0]), 0.0), 1.0)
    return (0.0, 0.0, -size * (thrust[0] + thrust[1]) * stalled, 0.0, 0.0, 0.0)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rate of the stall."""
    size, middle, half = p  # noqa: RUF059
    a = memory[0]
    over = FOLD * (-motion.airspeed[2] - middle) / max(half, 0.005)
    return ((a - a * a * a + min(max(over, -2.0), 2.0)) / TAKES,)


KIND: Final = OutsideKind(
    WrenchEffect('stall', PARAMETERS, wrench, memory=(('wash', -1.0),), rate=rate),
    'lifting rotors that stall in their own wash in descent',
    {'size': (0.3, 0.7), 'middle': (0.02, 0.06), 'half': (0.01, 0.03)},
    late=True,
)
