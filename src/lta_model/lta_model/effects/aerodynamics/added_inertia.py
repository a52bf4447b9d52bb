"""
Added inertia: rotational inertia of the air that turns with the hull.

    A_2 = diag(roll, pitch, yaw)

about the hull centre. It is zero for a sphere and about an axis of revolution in an ideal fluid;
`mass_matrix.spheroid_added_mass` has Lamb's closed forms for spheroids. Not modelled: coupling
terms and the boundary layer.
"""

from lta_model.effects.protocol import AXES, EffectParameter, InertiaEffect, Values, Wrench

_SOURCE = 'Lamb 1932 art. 115; spread: 10 % of that of an oblate hull with a diameter of 1 m'

PARAMETERS = tuple(
    EffectParameter(axis, 'kg m2', 0.0, 0.0, 100.0, 5e-4, _SOURCE) for axis in AXES[3:]
)


def added_inertia_diagonal(p: Values) -> Wrench:
    """Return the diagonal of the added inertia matrix."""
    roll, pitch, yaw = p
    return (0.0, 0.0, 0.0, roll, pitch, yaw)


EFFECT = InertiaEffect('added_inertia', PARAMETERS, added_inertia_diagonal)
