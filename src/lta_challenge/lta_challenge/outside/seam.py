"""
A seam that buckles when the hull sinks and springs back when it rises: a jump of lift.

    F = size (a - 1) e_z at (lever, 0, 0),   a within -1 and 1
    a' = (a - a^3 + 0.385 (z - even) / half) / 0.2 s,   even' = (z - even) / 10 s

The outside pressure falls with height: a hull that rises by `half` becomes taut (a = 1), and one
that sinks by as much buckles (a = -1). Between, it keeps its state (hysteresis): the cubic folds
at 2 / (3 sqrt 3) = 0.385. A vent slowly equalises the pressure.
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
TAKES: Final = 0.2  # s; time scale of the buckling
EVENS: Final = 10.0  # s; time constant of the vent


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the lost lift of the buckled hull."""
    size, half, lever = p  # noqa: RUF059 (the kernel knows parameters by their order)
    r = motion.rotation
    lift = size * (min(max(memory[0], -1.0), 1.0) - 1.0)
    x, y, z = lift * r[6], lift * r[7], lift * r[8]
    # Moment of the force at (lever, 0, 0)
    return (x, y, z, 0.0, -lever * z, lever * y)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rates of the buckling and of the pressure equalisation."""
    size, half, lever = p  # noqa: RUF059
    a, above = memory[0], motion.position[2] - memory[1]
    # Limited far beyond the fold, where the state has switched anyway
    push = min(max(FOLD * above / max(half, 0.01), -2.0), 2.0)
    return ((a - a * a * a + push) / TAKES, above / EVENS)


KIND: Final = OutsideKind(
    WrenchEffect('seam', PARAMETERS, wrench, memory=(('taut', 1.0), ('even', 1.5)), rate=rate),
    'a hull seam that buckles and springs back',
    {'size': (0.002, 0.006), 'half': (0.04, 0.1), 'lever': (-0.15, 0.15)},
    late=True,
)
