"""
Lift of a round hull that flies nose up or nose down.

    F_z = -lift |v_h| v_z / (1 + stall sin(a)^2),   sin(a) = v_z / |v|

about the hull centre, along body z. v is the air-relative velocity, v_h its part along surge and
sway, a the incidence. At small incidence the force grows with a, by lift / (density S / 2) per
radian as a coefficient on an area S; beyond, the hull stalls. Across and along its axis a round
hull has none. It comes on top of the drag by axis, includes the drag due to lift, and dissipates.
Not modelled: the suction along the hull, which is a tenth of the drag of GT-MAB (docs/cfd.md).
"""

import math

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

_LIFT = (
    'OpenFOAM: 0.63 N s2/m2 of a 1 m oblate hull at 10 to 40 degrees (docs/cfd.md); spread: half'
)
_STALL = 'OpenFOAM: 4.5 for the same hull; spread: a third'

PARAMETERS = (
    EffectParameter('lift', 'N s2/m2', 0.0, 0.0, 100.0, 0.3, _LIFT),
    EffectParameter('stall', '1', 0.0, 0.0, 100.0, 1.5, _STALL),
)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the force along body z."""
    lift, stall = p
    x, y, z = motion.airspeed
    square = x * x + y * y + z * z
    # At rest there is no force, and no incidence
    share = z * z / square if square > 0.0 else 0.0
    force = -lift * math.sqrt(x * x + y * y) * z / (1.0 + stall * share)
    return (0.0, 0.0, force, 0.0, 0.0, 0.0)


EFFECT = WrenchEffect('oblique_lift', PARAMETERS, compute_wrench, linear_in=('lift',))
