"""
Gas that takes on the temperature of stratified air with a lag: lift that returns after a climb.

    F = -size (z - h) e_z,   h' = (z - h) / lag

Air below the ceiling is warmer, and lifts less until the gas has warmed too. h is the height at
which the air is as warm as the gas. In a slack hull the displaced mass m is proportional to the
ratio of both temperatures (gas law at equal pressure), so size = m g G / T: 14 mN/m for 0.41 kg,
a gradient G of 1 K/m and 293 K. A thin film passes some 9 W/K, and the gas holds about 300 J/K,
hence lags of half a minute.
"""

from typing import Final

from lta_challenge.outside.shared.axes import rotate_to_body
from lta_challenge.outside.shared.kind import OutsideKind
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS: Final = (
    EffectParameter('size', 'N/m', 0.0, 0.0, 0.1, 0.01, 'of a challenge'),
    EffectParameter('lag', 's', 0.0, 0.0, 1e4, 20.0, 'of a challenge'),
)


def wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the change of lift."""
    size, lag = p  # noqa: RUF059 (the kernel knows parameters by their order)
    x, y, z = rotate_to_body(motion.rotation, 0.0, 0.0, size * (memory[0] - motion.position[2]))
    return (x, y, z, 0.0, 0.0, 0.0)


def rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the rate of the height at which the air is as warm as the gas."""
    size, lag = p  # noqa: RUF059
    # The limit avoids a division by the null value of 0
    return ((motion.position[2] - memory[0]) / max(lag, 1.0),)


KIND: Final = OutsideKind(
    WrenchEffect('thermal_lag', PARAMETERS, wrench, memory=(('warm', 1.5),), rate=rate),
    'gas that warms and cools slowly in stratified air',
    {'size': (0.007, 0.03), 'lag': (8.0, 40.0)},
    late=True,
)
