"""
Added mass: the air that must be set in motion with the hull.

    M_a = diag(surge, sway, heave, roll, pitch, yaw)

about the hull centre; its momentum follows the air-relative velocity (`rigid_body`), which brings
the Munk moment with it. Lamb's closed forms for spheroids are in `mass.spheroid_added_mass`. Left
out: coupling terms of hulls without three planes of symmetry, walls and floor nearby.
"""

from lta_sim.effects.protocol import AXES, InertiaEffect, Parameter, Values, Wrench

_MASS = 'Lamb 1932 art. 114; prior: 10 % of a 0.4 kg hull, real flow separates'
_INERTIA = 'Lamb 1932 art. 115; prior: 10 % of a 1 m oblate hull'

PARAMETERS = tuple(
    Parameter(axis, 'kg', 0.0, 0.0, 100.0, 0.03, _MASS)
    if axis in AXES[:3]
    else Parameter(axis, 'kg m^2', 0.0, 0.0, 100.0, 5e-4, _INERTIA)
    for axis in AXES
)


def diagonal(p: Values) -> Wrench:
    """Return the diagonal of the added mass matrix."""
    surge, sway, heave, roll, pitch, yaw = p
    return (surge, sway, heave, roll, pitch, yaw)


EFFECT = InertiaEffect('added_mass', PARAMETERS, diagonal)
