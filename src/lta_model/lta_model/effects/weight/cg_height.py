"""
Centre of gravity higher or lower than where the parts put it.

    r' = r + (0, 0, z),   inertia about the hull centre by Steiner (`cg_shift`)

The mass and the inertia about the CG stay. It rights the vehicle less or more, which the period of
its swing shows; above the hull centre it flips.
"""

from lta_model.effects.protocol import BodyEffect, EffectParameter, RigidBody, Values
from lta_model.effects.weight.cg_shift import shift_cg

_SOURCE = (
    'prior: published depths of one GT-MAB are 5 cm and 8.7 to 9.7 cm, parts known to 1 cm '
    '(assumed); within a hull of 6 m'
)

PARAMETERS = (EffectParameter('z', 'm', 0.0, -3.0, 3.0, 0.01, _SOURCE),)


def change_body(p: Values, rigid: RigidBody) -> RigidBody:
    """Return the vehicle with its centre of gravity there."""
    (z,) = p
    return shift_cg(rigid, (0.0, 0.0, z))


EFFECT = BodyEffect('cg_height', PARAMETERS, change_body)
