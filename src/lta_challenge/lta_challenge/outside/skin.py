"""
A moment with hysteresis, caused by folds of the skin.

    N_y = -size a,   N_z = -size b,   a' = (q - |q| a) / s,   b' = (r - |r| b) / s

(Bouc and Wen): after a rotation of about s, the moment opposes it at any speed.
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N m', 0.0, 0.0, 1.0, 0.001, 'of a challenge'),
    EffectParameter('s', 'rad', 0.0, 0.0, 5.0, 0.1, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the moment of the skin."""
    size, s = p  # noqa: RUF059 (the kernel knows parameters by their order)
    return (0.0, 0.0, 0.0, 0.0, -size * memory[0], -size * memory[1])


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rates of the folds."""
    size, s = p  # noqa: RUF059
    q, r = motion.rates[1], motion.rates[2]
    wide = max(s, 0.01)
    return ((q - abs(q) * memory[0]) / wide, (r - abs(r) * memory[1]) / wide)


KIND: Final = OutsideKind(
    WrenchEffect('skin', PARAMETERS, wrench, memory=(('a', 0.0), ('b', 0.0)), rate=rate),
    'a hull skin whose folds resist rotation with hysteresis',
    {'size': (0.0005, 0.002), 's': (0.03, 0.3)},
)
