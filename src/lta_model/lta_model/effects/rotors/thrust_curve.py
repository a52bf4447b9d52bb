"""
Rotor thrust by duty.

    T = a u |u| + b u

u is the duty at which the rotor turns, -1 to 1. The parabola is that of 7 mm brushed motors in the
Crazyflie firmware (a = 0.0915 N, b = 0.0677 N), as an odd function for reversible rotors. At the
null values, a = 0 and b = 1 N, a command is the thrust in newtons. Not modelled: inflow.
"""

from lta_model.effects.protocol import ActuatorEffect, EffectParameter, Values

_SOURCE = 'bench tables of 7 mm motors deviate by 3 mN rms from the firmware curve; limit: 50 N'

EACH = (
    EffectParameter('a', 'N', 0.0, -50.0, 50.0, 0.003, _SOURCE),
    EffectParameter('b', 'N', 1.0, -50.0, 50.0, 0.003, _SOURCE),
)


def compute_output(p: Values, memory: Values, duty: float, surroundings: Values) -> float:
    """Return the thrust. [N]"""
    a, b = p
    # a u |u| + b u, an odd function
    return (a * abs(duty) + b) * duty


EFFECT = ActuatorEffect('thrust_curve', (), EACH, compute_output)
