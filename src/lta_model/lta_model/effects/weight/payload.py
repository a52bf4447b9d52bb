"""
Load carried at a place of the vehicle.

    m' = m + mass,   with its moment and inertia about the hull centre (`point_mass`)

It is not one of the vehicle's parts, so it is lifted and not trimmed away. Not modelled: its size,
its drag, and the air that it displaces.
"""

from lta_model.effects.protocol import BodyEffect, EffectParameter, RigidBody, Values
from lta_model.effects.weight.point_mass import with_point_mass

_MASS = 'spread: 2 g, as in the comparison of the seed paper; limit: an airship with 50 kg of lift'
_PLACE = 'spread: 5 cm for a position read off the vehicle (assumed); limits: a hull of 10 m'

PARAMETERS = (
    EffectParameter('mass', 'kg', 0.0, 0.0, 50.0, 0.002, _MASS),
    EffectParameter('x', 'm', 0.0, -5.0, 5.0, 0.05, _PLACE),
    EffectParameter('y', 'm', 0.0, -5.0, 5.0, 0.05, _PLACE),
    EffectParameter('z', 'm', 0.0, -5.0, 5.0, 0.05, _PLACE),
)


def change_body(p: Values, rigid: RigidBody) -> RigidBody:
    """Return the body with that load."""
    mass, x, y, z = p
    return with_point_mass(rigid, mass, (x, y, z))


EFFECT = BodyEffect('payload', PARAMETERS, change_body)
