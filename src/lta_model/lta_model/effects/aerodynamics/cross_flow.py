"""
Additional drag of a round hull in oblique flow, which drag per axis underestimates.

    F_i = -D_i (s_i - |v_i|) v_i
    s_x = |v_x| + horizontal (|v_h| - |v_x|) + total (|v| - |v_h|),   s_y alike
    s_z = |v_z| + total (|v| - |v_z|)

about the hull centre. v is the air-relative velocity, v_h its part along surge and sway, D the
coefficients of `quadratic_drag`. At 45 degrees to its axes a round hull has the drag D |v| v, but
-D |v_i| v_i gives only 0.71 of it. `horizontal` = 1 corrects this for a hull that is round seen
from above; `total` = 1 also corrects oblique climbs: with both, F = -D |v| v. A slender hull needs
neither, because its cross flow is independent of the axial flow (Allen and Perkins 1951, NACA
Report 1048). F dissipates for any share that is not negative, since s_i >= |v_i|.
"""

import math

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

_SHARE = 'by definition: 0 for a slender hull, 1 for a round one; spread: 0.2 (assumed)'
_DRAG = 'as quadratic_drag; Fossen 2011 sec. 6.4; spread: 20 % of that of a 1 m oblate hull'

PARAMETERS = (
    EffectParameter('horizontal', '1', 0.0, 0.0, 1.0, 0.2, _SHARE),
    EffectParameter('total', '1', 0.0, 0.0, 1.0, 0.2, _SHARE),
    *(
        EffectParameter(axis, 'N s2/m2', 0.0, 0.0, 100.0, 0.03, _DRAG)
        for axis in ('surge', 'sway', 'heave')
    ),
)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the drag missing from `quadratic_drag`."""
    horizontal, total, surge, sway, heave = p
    x, y, z = motion.airspeed
    square = x * x + y * y
    # |v_h| and |v|
    flat, speed = math.sqrt(square), math.sqrt(square + z * z)
    # The part that surge and sway share
    rest = total * (speed - flat)
    return (
        -surge * (horizontal * (flat - abs(x)) + rest) * x,
        -sway * (horizontal * (flat - abs(y)) + rest) * y,
        -heave * total * (speed - abs(z)) * z,
        0.0,
        0.0,
        0.0,
    )


EFFECT = WrenchEffect('cross_flow', PARAMETERS, compute_wrench, linear_in=('horizontal', 'total'))
