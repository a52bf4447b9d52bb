"""
Added inertia: the air that must be turned with the hull.

    A_2 = diag(roll, pitch, yaw)

about the hull centre. Nothing for a sphere or about an axis of revolution in an ideal fluid;
Lamb's closed forms for spheroids are in `mass.spheroid_added_mass`. Left out: coupling terms, and
the layer that friction drags along.
"""

from lta_model.effects.protocol import AXES, EffectParameter, InertiaEffect, Values, Wrench

_SOURCE = 'Lamb 1932 art. 115; prior: 10 % of a 1 m oblate hull'

PARAMETERS = tuple(
    EffectParameter(axis, 'kg m2', 0.0, 0.0, 100.0, 5e-4, _SOURCE) for axis in AXES[3:]
)


def compute_diagonal(p: Values) -> Wrench:
    """Return the diagonal of the added inertia matrix."""
    roll, pitch, yaw = p
    return (0.0, 0.0, 0.0, roll, pitch, yaw)


EFFECT = InertiaEffect('added_inertia', PARAMETERS, compute_diagonal)
