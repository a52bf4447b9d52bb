"""
Reduction of the Munk moment by flow separation behind a real hull.

    N = lost (v x A v)

about the hull centre; v is the air-relative velocity, A the added mass. The rigid body has the
full moment -v x A v of attached flow (Munk 1924, NACA Report 184), which turns the hull broadside
on. Behind a real hull the flow separates and the rear carries less load (Allen and Perkins 1951,
NACA Report 1048), so a share `lost` of it is missing. The moment is at most half the difference of
two added masses times |v|^2, and does not brake the hull. Not modelled: dependence on the angle.
"""

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect
from lta_model.state import ADDED

_SHARE = (
    'Hoerner 1965: wind tunnels show a smaller moment than Munk (unverified, from memory); '
    'spread: 0.2'
)

PARAMETERS = (EffectParameter('lost', '1', 0.0, -0.5, 1.0, 0.2, _SHARE),)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the moment that cancels the lost share of the Munk moment."""
    (lost,) = p
    x, y, z = motion.airspeed
    a, b, c = motion.body[ADDED], motion.body[ADDED + 1], motion.body[ADDED + 2]
    return (
        0.0,
        0.0,
        0.0,
        # v x A v for the diagonal A = (a, b, c)
        lost * (c - b) * y * z,
        lost * (a - c) * z * x,
        lost * (b - a) * x * y,
    )


EFFECT = WrenchEffect('munk_moment', PARAMETERS, compute_wrench, linear_in=('lost',))
