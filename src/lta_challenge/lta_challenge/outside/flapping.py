"""
A loose panel that flaps in the airflow.

    F_x = -size |v|^2 (1 + q),   N_z = side size |v|^2 (1 + q),   q'' = f (1 - q^2) q' - f^2 q

v is the velocity through the air; q is a self-excited oscillation (van der Pol).
"""

from typing import Final

from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N s2/m2', 0.0, 0.0, 10.0, 0.02, 'of a challenge'),
    EffectParameter('f', 'rad/s', 0.0, 0.0, 50.0, 5.0, 'of a challenge'),
    EffectParameter('side', 'm', 0.0, -2.0, 2.0, 0.3, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the drag of the panel."""
    size, f, side = p  # noqa: RUF059 (the kernel knows parameters by their order)
    v = motion.airspeed
    drag = size * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * (1.0 + memory[0])
    return (-drag, 0.0, 0.0, 0.0, 0.0, side * drag)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rates of the oscillation."""
    size, f, side = p  # noqa: RUF059
    q, s = memory[0], memory[1]
    return (s, f * (1.0 - q * q) * s - f * f * q)


KIND: Final = OutsideKind(
    WrenchEffect('flapping', PARAMETERS, wrench, memory=(('q', 0.5), ('s', 0.0)), rate=rate),
    'a loose panel that flaps',
    {'size': (0.01, 0.04), 'f': (3.0, 9.0), 'side': (-0.4, 0.4)},
)
