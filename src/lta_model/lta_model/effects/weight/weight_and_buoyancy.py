"""
Weight at the centre of gravity, buoyancy at the hull centre.

With e_z the map's vertical seen from the body, m the mass of the solid parts and of the gas, r its
centre, m_d the mass of the displaced air and g the acceleration of gravity:

    F = (m_d - m) g e_z,    N = m r x (-g e_z)

A CG below the hull centre rights the vehicle. Archimedes acts through the air's own weight only,
so a steady wind does not enter; what accelerating air adds is in `rigid_body`. Mass, balance and
displaced air are the body's (`lta_model.state`), so that whatever changes them changes this.
"""

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect
from lta_model.state import DISPLACED, MASS, MASS_MOMENT

PARAMETERS = (
    EffectParameter(
        'gravity',
        'm/s2',
        0.0,
        0.0,
        30.0,
        0.005,
        'normal gravity; prior: between latitudes, 0.5 %',
    ),
)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return net lift and righting moment."""
    (gravity,) = p
    up, body = motion.rotation, motion.body
    net = (body[DISPLACED] - body[MASS]) * gravity
    x, y, z = (
        body[MASS_MOMENT] * gravity,
        body[MASS_MOMENT + 1] * gravity,
        body[MASS_MOMENT + 2] * gravity,
    )
    return (
        net * up[6],
        net * up[7],
        net * up[8],
        z * up[7] - y * up[8],
        x * up[8] - z * up[6],
        y * up[6] - x * up[7],
    )


EFFECT = WrenchEffect('weight_and_buoyancy', PARAMETERS, compute_wrench, ('gravity',))
