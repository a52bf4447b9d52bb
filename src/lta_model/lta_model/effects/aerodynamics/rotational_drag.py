"""
Linear and quadratic damping of the body rates.

    N_i = -(D_i + D_2i |w_i|) w_i

about the hull centre: skin friction about an axis of revolution, form drag of gondola and hull
about the others; the linear part is for small rates (Fossen 2011, section 6.4, eqs. 6.57 and
6.58). Coefficients from steady rotation in a wind tunnel underestimate the damping of fast
oscillations, because the air turns along; `strip_damping` adds that of frames and panels.
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

PARAMETERS = (
    *(EffectParameter(axis, 'N m s', 0.0, 0.0, 100.0, 5e-4, _SOURCE) for axis in AXES[3:]),
    *(EffectParameter(f'{axis}_2', 'N m s2', 0.0, 0.0, 100.0, 5e-4, _SOURCE) for axis in AXES[3:]),
)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the damping moment."""
    roll, pitch, yaw, roll_2, pitch_2, yaw_2 = p
    w = motion.rates
    return (
        0.0,
        0.0,
        0.0,
        # |w| w keeps the sign: both parts oppose the rotation
        -(roll + roll_2 * abs(w[0])) * w[0],
        -(pitch + pitch_2 * abs(w[1])) * w[1],
        -(yaw + yaw_2 * abs(w[2])) * w[2],
    )


EFFECT = WrenchEffect(
    'rotational_drag', PARAMETERS, compute_wrench, tuple(known.name for known in PARAMETERS)
)
