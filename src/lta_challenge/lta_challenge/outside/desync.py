"""
A motor whose controller loses synchronisation at a fast increase of duty, and regains it.

    F_x = -size T,   N = r x F,   T = T_3 lost
    lost' = 40 / s (1 - lost) where d - slow > jump, less lost / back;   slow' = (d - slow) / 0.1 s

d is the commanded duty of the third rotor, r = (0, 0.1, -0.4) m.
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', '1', 0.0, 0.0, 1.0, 0.5, 'of a challenge'),
    EffectParameter('jump', '1', 0.0, 0.0, 1.0, 0.1, 'of a challenge'),
    EffectParameter('back', 's', 0.0, 0.0, 20.0, 0.5, 'of a challenge'),
)
TOLD: Final = 2  # the third rotor
LOSES: Final = 40.0  # 1/s; rate at which synchronisation is lost
FOLLOWS: Final = 0.1  # s; time constant of the low-pass filtered duty


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the thrust that is missing."""
    size, jump, back = p  # noqa: RUF059 (the kernel knows parameters by their order)
    x = -size * thrust[TOLD] * memory[0]
    # Moment r x F with r = (0, 0.1, -0.4) m
    return (x, 0.0, 0.0, 0.0, -0.4 * x, -0.1 * x)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rates of the lost share and of the filtered duty."""
    size, jump, back = p  # noqa: RUF059
    lost, slow = memory[0], memory[1]
    command = motion.command[TOLD]
    loses = LOSES * (1.0 - lost) if command - slow > jump else 0.0
    return (loses - lost / max(back, 0.05), (command - slow) / FOLLOWS)


KIND: Final = OutsideKind(
    WrenchEffect('desync', PARAMETERS, wrench, memory=(('lost', 0.0), ('slow', 0.0)), rate=rate),
    'a motor that loses synchronisation',
    {'size': (0.3, 0.8), 'jump': (0.06, 0.14), 'back': (0.2, 0.8)},
    late=True,
)
