"""
Vertical shift of the centre of gravity.

    r' = r + (0, 0, z),   inertia about the hull centre by Steiner (`cg_shift`)

Mass and inertia about the CG stay. The shift changes the righting moment, and so the period of the
pendulum motion; a CG above the hull centre is unstable.
"""

from lta_model.effects.protocol import BodyEffect, EffectParameter, RigidBody, Values
from lta_model.effects.weight.cg_shift import with_cg_shifted

_SOURCE = (
    'spread: published depths of the CG of one GT-MAB are 5 cm and 8.7 to 9.7 cm, with '
    'parts known to 1 cm (assumed); limits: a hull of 6 m'
)

PARAMETERS = (EffectParameter('z', 'm', 0.0, -3.0, 3.0, 0.01, _SOURCE),)


def change_body(p: Values, rigid: RigidBody) -> RigidBody:
    """Return the body with the shifted CG."""
    (z,) = p
    return with_cg_shifted(rigid, (0.0, 0.0, z))


EFFECT = BodyEffect('cg_height', PARAMETERS, change_body)
