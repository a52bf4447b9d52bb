"""
Drag proportional to the square of the airspeed, per axis.

    F_i = -D_i |v_r,i| v_r,i,   D = rho C_D A / 2

about the hull centre; v_r is the air-relative velocity (Fossen 2011, section 6.4, eq. 6.58). For a
round hull at 45 degrees this gives 0.71 of the drag; `cross_flow` corrects it.
"""

from lta_model.effects.protocol import (
    AXES,
    EffectParameter,
    Values,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)

_SOURCE = 'Fossen 2011 sec. 6.4; spread: 20 % of that of a 1 m oblate hull'

PARAMETERS = tuple(
    EffectParameter(axis, 'N s2/m2', 0.0, 0.0, 100.0, 0.03, _SOURCE) for axis in AXES[:3]
)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the drag."""
    surge, sway, heave = p
    v = motion.airspeed
    return (
        # |v| v instead of v^2 keeps the sign, so that the force always opposes the motion
        -surge * abs(v[0]) * v[0],
        -sway * abs(v[1]) * v[1],
        -heave * abs(v[2]) * v[2],
        0.0,
        0.0,
        0.0,
    )


EFFECT = WrenchEffect('quadratic_drag', PARAMETERS, compute_wrench, AXES[:3])
