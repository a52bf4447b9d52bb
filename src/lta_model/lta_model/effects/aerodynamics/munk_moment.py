"""
The part of the Munk moment that a real flow does not exert.

    N = lost (v x A v)

about the hull centre; v is the air-relative velocity, A the added mass. The rigid body has the
whole moment -v x A v, that of a flow which closes behind the hull (Munk 1924, NACA Report 184) and
turns it broadside on. Behind a real hull the flow separates and the rear carries less (Allen and
Perkins 1951, NACA Report 1048): a share `lost` of it does not happen. It is at most half the
difference of two added masses times |v|^2, and turns the hull without braking it. Left out: that
the share depends on the angle.
"""

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect
from lta_model.state import ADDED

_SHARE = 'Hoerner 1965: wind tunnels show less than Munk (unverified, from memory); prior: 0.2'

PARAMETERS = (EffectParameter('lost', '1', 0.0, -0.5, 1.0, 0.2, _SHARE),)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the excess of the Munk moment."""
    (lost,) = p
    x, y, z = motion.airspeed
    a, b, c = motion.body[ADDED], motion.body[ADDED + 1], motion.body[ADDED + 2]
    return (
        0.0,
        0.0,
        0.0,
        lost * (c - b) * y * z,
        lost * (a - c) * z * x,
        lost * (b - a) * x * y,
    )


EFFECT = WrenchEffect('munk_moment', PARAMETERS, compute_wrench, linear_in=('lost',))
