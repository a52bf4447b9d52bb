"""
Deadband of a brushed motor at small duty.

    u' = u   if |u| >= threshold,   else 0

At rest the current is u V / R, and below some duty its torque does not overcome brushes, bearings
and cogging. Above it the whole duty acts: the thrust curve was measured against the commanded duty
and passes the origin (four Crazyflie motors turn at 4485 rpm at 6.25 % duty, 9374 rpm at 18.75 %),
so it includes running friction; hence a jump and no shift. The command is constant during a step,
so the jump does not disturb the integrator. Not modelled: hysteresis between start and stop, and
the full-duty pulse with which some drivers start the motor.

Table: Bitcraze, crazyflie-firmware, docs/functional-areas/pwm-to-thrust.md (2015).
"""

from lta_model.effects.protocol import ActuatorEffect, EffectParameter, Values

_SOURCE = 'Bitcraze 2015: 7 mm motors turn at 6.25 % duty; limit and spread assumed'

SHARED = (EffectParameter('threshold', '1', 0.0, 0.0, 0.5, 0.03, _SOURCE),)


def compute_output(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """Return the duty that turns the motor."""
    (threshold,) = p
    # The deadband is symmetric for reversible rotors
    return value if abs(value) >= threshold else 0.0


EFFECT = ActuatorEffect('motor_deadband', SHARED, (), compute_output)
