"""
Drag proportional to the speed through the air, on six axes.

    F_i = -D_i v_r,i,    N_i = -D_i w_i

about the hull centre, v_r the air-relative velocity. Skin friction at low Reynolds number and the
small-rate part of rotational damping. Source: the linear part of the diagonal drag of small blimps
(Fossen 2011, section 6.4, eq. 6.57).
"""

from lta_sim.effects.protocol import AXES, Duty, Motion, Parameter, Values, Wrench, WrenchEffect

_SOURCE = 'Fossen 2011 sec. 6.4; prior: the scatter of published indoor blimps'

PARAMETERS = tuple(
    Parameter(axis, 'N s/m', 0.0, 0.0, 100.0, 0.01, _SOURCE)
    if axis in AXES[:3]
    else Parameter(axis, 'N m s', 0.0, 0.0, 100.0, 5e-4, _SOURCE)
    for axis in AXES
)


def wrench(p: Values, motion: Motion, duty: Duty) -> Wrench:
    """Return the drag and the damping moment."""
    surge, sway, heave, roll, pitch, yaw = p
    v, w = motion.airspeed, motion.rates
    return (
        -surge * v[0],
        -sway * v[1],
        -heave * v[2],
        -roll * w[0],
        -pitch * w[1],
        -yaw * w[2],
    )


EFFECT = WrenchEffect('linear_drag', PARAMETERS, wrench, AXES)
