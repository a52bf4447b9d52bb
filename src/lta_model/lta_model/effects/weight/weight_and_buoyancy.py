"""
Weight at the centre of gravity, buoyancy at the hull centre.

With e_z the map's vertical in the body frame, m the mass of the solid parts and of the gas, r its
centre, m_d the mass of the displaced air and g the acceleration of gravity:

    F = (m_d - m) g e_z,    N = m r x (-g e_z)

A CG below the hull centre rights the vehicle. Buoyancy balances the air's weight only, so a steady
wind does not enter; `rigid_body` adds that of accelerating air. Mass, balance and displaced air
come from the body (`lta_model.state`), so every change of them acts here.
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
        'standard gravity; spread: 0.5 %, the difference between latitudes',
    ),
)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return net lift and righting moment."""
    (gravity,) = p
    up, body = motion.rotation, motion.body
    # Positive for a vehicle lighter than air
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
        # m r x (-g e_z)
        z * up[7] - y * up[8],
        x * up[8] - z * up[6],
        y * up[6] - x * up[7],
    )


EFFECT = WrenchEffect('weight_and_buoyancy', PARAMETERS, compute_wrench, ('gravity',))
