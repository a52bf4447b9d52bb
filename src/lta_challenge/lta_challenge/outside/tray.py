"""
A battery that slides in its tray beyond a pitch angle, and stays where it stops.

    N = (x, 0, 0) x (-size e_z),   x' = 1 m/s (s - grip) where s > grip, 1 m/s (s + grip) where
    s < -grip, 0 between and at a stop;   s = sin of the pitch, nose down

size is its weight, x its displacement from the middle, limited to half the play.
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N', 0.0, 0.0, 1.5, 0.2, 'of a challenge'),
    EffectParameter('half', 'm', 0.0, 0.0, 0.2, 0.015, 'of a challenge'),
    EffectParameter('grip', '1', 0.0, 0.0, 1.0, 0.02, 'of a challenge'),
)
SLIDES: Final = 1.0  # m/s on a vertical tray without grip


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the moment of the displaced battery."""
    size, half, grip = p  # noqa: RUF059 (the kernel knows parameters by their order)
    r = motion.rotation
    way = min(max(memory[0], -half), half)
    return (0.0, 0.0, 0.0, 0.0, size * way * r[8], -size * way * r[7])


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the sliding speed."""
    size, half, grip = p  # noqa: RUF059
    # Sine of the pitch, nose down positive
    steep = -motion.rotation[6]
    # Zero within the friction, linear beyond
    speed = SLIDES * (steep - min(max(steep, -grip), grip))
    if (memory[0] >= half and speed > 0.0) or (memory[0] <= -half and speed < 0.0):
        speed = 0.0
    return (speed,)


KIND: Final = OutsideKind(
    WrenchEffect('tray', PARAMETERS, wrench, memory=(('way', 0.0),), rate=rate),
    'a battery that slides in its tray',
    {'size': (0.1, 0.4), 'half': (0.005, 0.02), 'grip': (0.01, 0.04)},
    late=True,
)
