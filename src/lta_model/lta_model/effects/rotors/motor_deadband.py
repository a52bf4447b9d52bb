"""
A brushed motor that does not turn at a small duty.

    u' = u   if |u| >= threshold,   else 0

At rest the current is u V / R, and below some duty its torque does not overcome brushes, bearings
and cogging. Once the motor turns, the whole duty works: the thrust curve was measured against the
commanded duty and goes through the origin (four Crazyflie motors turn at 4485 rpm at 6.25 % duty,
9374 rpm at 18.75 %), so running friction is in the curve already and nothing may be subtracted
here. Hence a jump and no shift. It acts on the command, which is constant during a step, so that
the jump costs the integrator nothing. Odd in the duty. Left out: that a motor once turning stops
at a smaller duty than it starts at, and the full pulse with which some drivers start it.

Table: Bitcraze, crazyflie-firmware, docs/functional-areas/pwm-to-thrust.md (2015).
"""

from lta_model.effects.protocol import ActuatorEffect, EffectParameter, Values

_SOURCE = 'Bitcraze 2015: 7 mm motors turn at 6.25 % duty; bound and prior assumed'

SHARED = (EffectParameter('threshold', '1', 0.0, 0.0, 0.5, 0.03, _SOURCE),)


def compute_output(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """Return the duty that turns the motor."""
    (threshold,) = p
    return value if abs(value) >= threshold else 0.0


EFFECT = ActuatorEffect('motor_deadband', SHARED, (), compute_output)
