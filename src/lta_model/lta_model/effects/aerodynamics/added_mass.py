"""
Added mass: inertia of the air that accelerates with the hull.

    A_1 = diag(surge, sway, heave)

about the hull centre. Its momentum follows the air-relative velocity (`rigid_body`), which
includes the Munk moment. `mass_matrix.spheroid_added_mass` has Lamb's closed forms for spheroids.
Not modelled: coupling terms of hulls without three planes of symmetry, nearby walls and floor.
"""

from lta_model.effects.protocol import AXES, EffectParameter, InertiaEffect, Values, Wrench

_SOURCE = 'Lamb 1932 art. 114; spread: 10 % of that of a 0.4 kg hull, because real flow separates'

PARAMETERS = tuple(
    EffectParameter(axis, 'kg', 0.0, 0.0, 100.0, 0.03, _SOURCE) for axis in AXES[:3]
)


def added_mass_diagonal(p: Values) -> Wrench:
    """Return the diagonal of the added mass matrix."""
    surge, sway, heave = p
    return (surge, sway, heave, 0.0, 0.0, 0.0)


EFFECT = InertiaEffect('added_mass', PARAMETERS, added_mass_diagonal)
