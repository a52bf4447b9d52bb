"""
A seam that buckles when the hull sinks and springs back when it rises: a jump of lift.

    F = size (a - 1) e_z at (lever, 0, 0),   a within -1 and 1
    a' = (a - a^3 + 0.385 (z - even) / half) / 0.2 s,   even' = (z - even) / 10 s

The air outside is thinner higher up, so that a hull that rises by `half` comes taut (a = 1) and
one that sinks by as much is buckled (a = -1); between, it stays what it was: 2 / (3 sqrt 3) =
0.385 is where the cubic folds. A vent evens the pressure out.
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N', 0.0, 0.0, 0.03, 0.005, 'of a challenge'),
    EffectParameter('half', 'm', 0.0, 0.0, 20.0, 0.1, 'of a challenge'),
    EffectParameter('lever', 'm', 0.0, -1.0, 1.0, 0.1, 'of a challenge'),
)
FOLD: Final = 0.3849  # 2 / (3 sqrt 3)
TAKES: Final = 0.2  # s
EVENS: Final = 10.0  # s


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the lift that the buckled hull lacks."""
    size, half, lever = p  # noqa: RUF059 (the kernel knows parameters by their order)
    r = motion.rotation
    lift = size * (min(max(memory[0], -1.0), 1.0) - 1.0)
    x, y, z = lift * r[6], lift * r[7], lift * r[8]
    return (x, y, z, 0.0, -lever * z, lever * y)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return how fast it buckles, and how the pressure evens out."""
    size, half, lever = p  # noqa: RUF059
    a, above = memory[0], motion.position[2] - memory[1]
    push = min(max(FOLD * above / max(half, 0.01), -2.0), 2.0)
    return ((a - a * a * a + push) / TAKES, above / EVENS)


KIND: Final = OutsideKind(
    WrenchEffect('seam', PARAMETERS, wrench, memory=(('taut', 1.0), ('even', 1.5)), rate=rate),
    'a seam that buckles and springs back',
    {'size': (0.002, 0.006), 'half': (0.04, 0.1), 'lever': (-0.15, 0.15)},
    late=True,
)
