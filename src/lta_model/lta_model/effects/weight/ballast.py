"""
Ballast added to, or removed from, a place of the vehicle.

    m' = m + mass,   with its moment and inertia about the hull centre (`point_mass`)

It adds to the ballast that trims the vehicle to the heaviness in its file; negative is removed.
Not modelled: its size, and the air that it displaces (1 g of water 1.2 mg, of steel 0.15 mg).
"""

from lta_model.effects.protocol import BodyEffect, EffectParameter, RigidBody, Values
from lta_model.effects.weight.point_mass import with_point_mass

_MASS = (
    'spread: 2 g, the accuracy of trimming a balloon (assumed); limits: trim of a small vehicle'
)
_PLACE = 'spread: 5 cm for a position read off the vehicle (assumed); limits: a hull of 10 m'

PARAMETERS = (
    EffectParameter('mass', 'kg', 0.0, -1.0, 1.0, 0.002, _MASS),
    EffectParameter('x', 'm', 0.0, -5.0, 5.0, 0.05, _PLACE),
    EffectParameter('y', 'm', 0.0, -5.0, 5.0, 0.05, _PLACE),
    EffectParameter('z', 'm', 0.0, -5.0, 5.0, 0.05, _PLACE),
)


def change_body(p: Values, rigid: RigidBody) -> RigidBody:
    """Return the body with that ballast."""
    mass, x, y, z = p
    return with_point_mass(rigid, mass, (x, y, z))


EFFECT = BodyEffect('ballast', PARAMETERS, change_body)
