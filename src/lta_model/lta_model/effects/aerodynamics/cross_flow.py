"""
What the drag axis by axis leaves out: that the flow comes from one side only.

    F_i = -D_i (s_i - |v_i|) v_i
    s_x = |v_x| + horizontal (|v_h| - |v_x|) + total (|v| - |v_h|),   s_y alike
    s_z = |v_z| + total (|v| - |v_z|)

about the hull centre; v is the air-relative velocity, v_h its part along surge and sway, D the
coefficients of `quadratic_drag`. A round hull that flies at 45 degrees to its axes has the drag of
its axes times |v|, but -D |v_i| v_i gives it only 0.71 of that. `horizontal` = 1 mends it for a
hull that is round seen from above; `total` = 1 also for one that goes up or down askew: with both,
F = -D |v| v. A slender hull has neither: there the flow across it is as if there were none along
it (Allen and Perkins 1951, NACA Report 1048). F slows the vehicle for any share that is not
negative, since s_i >= |v_i|.
"""

import math

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

_SHARE = 'by the shape: 0 slender, 1 round; prior: 0.2, assumed'
_DRAG = 'those of quadratic_drag; Fossen 2011 sec. 6.4; prior: 20 % of a 1 m oblate hull'

PARAMETERS = (
    EffectParameter('horizontal', '1', 0.0, 0.0, 1.0, 0.2, _SHARE),
    EffectParameter('total', '1', 0.0, 0.0, 1.0, 0.2, _SHARE),
    *(
        EffectParameter(axis, 'N s2/m2', 0.0, 0.0, 100.0, 0.03, _DRAG)
        for axis in ('surge', 'sway', 'heave')
    ),
)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the missing part of the drag."""
    horizontal, total, surge, sway, heave = p
    x, y, z = motion.airspeed
    square = x * x + y * y
    flat, speed = math.sqrt(square), math.sqrt(square + z * z)
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
