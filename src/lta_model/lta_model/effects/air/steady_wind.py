"""
Uniform steady wind.

    U = (x, y, z),    DU/Dt = 0

in `map`, as the direction of the flow (not where the wind comes from).
"""

from lta_model.effects.protocol import AirEffect, AirEffectInput, EffectParameter, Values, Wrench

_SOURCE = 'spread: an indoor draught (assumed); limits: stronger than any storm'

PARAMETERS = tuple(
    EffectParameter(axis, 'm/s', 0.0, -60.0, 60.0, 0.1, _SOURCE) for axis in ('x', 'y', 'z')
)


def compute_air_motion(p: Values, memory: Values, place: AirEffectInput) -> Wrench:
    """Return the wind."""
    x, y, z = p
    return (x, y, z, 0.0, 0.0, 0.0)


EFFECT = AirEffect('steady_wind', PARAMETERS, compute_air_motion)
