"""
Drag proportional to the airspeed, per axis.

    F_i = -D_i v_r,i

about the hull centre; v_r is the air-relative velocity. Skin friction at low Reynolds number: the
linear part of the diagonal drag of small blimps (Fossen 2011, section 6.4, eq. 6.57).
"""

from lta_model.effects.protocol import (
    AXES,
    EffectParameter,
    Values,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)

_SOURCE = 'Fossen 2011 sec. 6.4; spread: scatter of published indoor blimps'

PARAMETERS = tuple(
    EffectParameter(axis, 'N s/m', 0.0, 0.0, 100.0, 0.01, _SOURCE) for axis in AXES[:3]
)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the drag."""
    surge, sway, heave = p
    v = motion.airspeed
    return (-surge * v[0], -sway * v[1], -heave * v[2], 0.0, 0.0, 0.0)


EFFECT = WrenchEffect('linear_drag', PARAMETERS, compute_wrench, AXES[:3])
