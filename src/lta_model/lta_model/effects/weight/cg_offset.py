"""
Centre of gravity ahead of or beside where the parts put it.

    r' = r + (x, y, 0),   inertia about the hull centre by Steiner (`cg_shift`)

The mass and the inertia about the CG stay. What a tilt at rest shows: tan(tilt) is the offset over
the depth of the CG below the hull centre.
"""

from lta_model.effects.protocol import BodyEffect, EffectParameter, RigidBody, Values
from lta_model.effects.weight.cg_shift import shift_cg

_SOURCE = 'prior: 5 mm on a balanced CG, 3.6 deg at 8 cm depth (assumed); within a hull of 6 m'

PARAMETERS = (
    EffectParameter('x', 'm', 0.0, -3.0, 3.0, 0.005, _SOURCE),
    EffectParameter('y', 'm', 0.0, -3.0, 3.0, 0.005, _SOURCE),
)


def change_body(p: Values, rigid: RigidBody) -> RigidBody:
    """Return the vehicle with its centre of gravity there."""
    x, y = p
    return shift_cg(rigid, (x, y, 0.0))


EFFECT = BodyEffect('cg_offset', PARAMETERS, change_body)
