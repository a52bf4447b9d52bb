"""
Drag proportional to the square of the speed through the air, on six axes.

    F_i = -D_i |v_r,i| v_r,i,    N_i = -D_i |w_i| w_i

about the hull centre, v_r the air-relative velocity; D = rho C_D A / 2 for a translation. Axis by
axis, as in the diagonal model of small blimps (Fossen 2011, section 6.4, eq. 6.58). Left out: the
cross flow at an angle of attack.
"""

from lta_sim.effects.protocol import AXES, Duty, Motion, Parameter, Values, Wrench, WrenchEffect

_SOURCE = 'Fossen 2011 sec. 6.4; prior: 20 % of a 1 m oblate hull'

PARAMETERS = tuple(
    Parameter(axis, 'N s^2/m^2', 0.0, 0.0, 100.0, 0.03, _SOURCE)
    if axis in AXES[:3]
    else Parameter(axis, 'N m s^2', 0.0, 0.0, 100.0, 5e-4, _SOURCE)
    for axis in AXES
)


def wrench(p: Values, motion: Motion, duty: Duty) -> Wrench:
    """Return the drag and the damping moment."""
    surge, sway, heave, roll, pitch, yaw = p
    v, w = motion.airspeed, motion.rates
    return (
        -surge * abs(v[0]) * v[0],
        -sway * abs(v[1]) * v[1],
        -heave * abs(v[2]) * v[2],
        -roll * abs(w[0]) * w[0],
        -pitch * abs(w[1]) * w[1],
        -yaw * abs(w[2]) * w[2],
    )


EFFECT = WrenchEffect('quadratic_drag', PARAMETERS, wrench, AXES)
