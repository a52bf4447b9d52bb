"""
Soft floor under the landing point, for standing and take-off.

The landing point (x, y, z) is fixed in the body; d is its depth below the floor z = 0 of the map
and v its velocity over the ground:

    normal    P = stiffness max(0, d + relaxation d/dt d)   while d > 0, else 0
    friction  Q = -friction P v_h / sqrt(|v_h|^2 + v_s^2),   v_s = 0.05 m/s

A one-sided Kelvin-Voigt spring with Coulomb friction smoothed below v_s for an explicit
integrator: under a side force a standing vehicle creeps instead of sticking. The normal force
never pulls. Not modelled: rolling and spinning friction, edges, more than one contact point.
"""

import math

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

_SOURCE = 'spread: a foam foot that yields by millimetres under a load of grams; not measured'
_PLACE = 'spread: 5 mm for the position of the foot; limits: a hull of 5 m'

PARAMETERS = (
    EffectParameter('stiffness', 'N/m', 0.0, 0.0, 1e4, 50.0, _SOURCE),
    EffectParameter('relaxation', 's', 0.0, 0.0, 10.0, 0.05, _SOURCE),
    EffectParameter('friction', '1', 0.0, 0.0, 3.0, 0.2, _SOURCE),
    EffectParameter('x', 'm', 0.0, -5.0, 5.0, 0.005, _PLACE),
    EffectParameter('y', 'm', 0.0, -5.0, 5.0, 0.005, _PLACE),
    EffectParameter('z', 'm', 0.0, -5.0, 5.0, 0.005, _PLACE),
)

# m/s; below it friction grows linearly with the speed
SLIP_SPEED = 0.05


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the floor's wrench at the landing point."""
    stiffness, relaxation, friction, x, y, z = p
    r, v, w = motion.rotation, motion.velocity, motion.rates
    # Third row of R gives the height of the landing point
    depth = -(motion.position[2] + r[6] * x + r[7] * y + r[8] * z)
    # Velocity of the landing point, v + w x r, in the body frame
    u = v[0] + w[1] * z - w[2] * y
    s = v[1] + w[2] * x - w[0] * z
    h = v[2] + w[0] * y - w[1] * x
    # The same velocity in map axes
    east = r[0] * u + r[1] * s + r[2] * h
    north = r[3] * u + r[4] * s + r[5] * h
    up = r[6] * u + r[7] * s + r[8] * h
    # d/dt depth = -up; the max keeps the floor from pulling
    normal = stiffness * max(0.0, depth - relaxation * up) if depth > 0.0 else 0.0
    grip = -friction * normal / math.sqrt(east * east + north * north + SLIP_SPEED * SLIP_SPEED)
    # Back to the body frame (transpose of R), where wrenches are summed
    f_x = r[0] * grip * east + r[3] * grip * north + r[6] * normal
    f_y = r[1] * grip * east + r[4] * grip * north + r[7] * normal
    f_z = r[2] * grip * east + r[5] * grip * north + r[8] * normal
    return (f_x, f_y, f_z, y * f_z - z * f_y, z * f_x - x * f_z, x * f_y - y * f_x)


EFFECT = WrenchEffect('floor_contact', PARAMETERS, compute_wrench, ('stiffness',))
