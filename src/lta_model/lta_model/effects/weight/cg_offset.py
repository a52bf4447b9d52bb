"""
Horizontal shift of the centre of gravity.

    r' = r + (x, y, 0),   inertia about the hull centre by Steiner (`cg_shift`)

Mass and inertia about the CG stay. The tilt at rest shows it: tan(tilt) is the offset over the
depth of the CG below the hull centre.
"""

from lta_model.effects.protocol import BodyEffect, EffectParameter, RigidBody, Values
from lta_model.effects.weight.cg_shift import with_cg_shifted

_SOURCE = (
    'spread: 5 mm for a balanced CG, 3.6 deg of tilt at a depth of 8 cm (assumed); limits: a '
    'hull of 6 m'
)

PARAMETERS = (
    EffectParameter('x', 'm', 0.0, -3.0, 3.0, 0.005, _SOURCE),
    EffectParameter('y', 'm', 0.0, -3.0, 3.0, 0.005, _SOURCE),
)


def change_body(p: Values, rigid: RigidBody) -> RigidBody:
    """Return the body with the shifted CG."""
    x, y = p
    return with_cg_shifted(rigid, (x, y, 0.0))


EFFECT = BodyEffect('cg_offset', PARAMETERS, change_body)
