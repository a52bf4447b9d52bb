"""
All rotors stronger or weaker than their curve says.

    T' = factor T

What separates one batch of motors or one air from the bench: at a given speed of the rotor, thrust
goes with the density of the air, 6 % less at 600 m above the sea (standard atmosphere) or in air
20 K warmer (293 K / 313 K).
"""

from lta_model.effects.protocol import ActuatorEffect, EffectParameter, Values

_SOURCE = 'Bitcraze 2015: its own bench lies 3 mN rms of up to 142 mN from the firmware curve'

SHARED = (EffectParameter('factor', '1', 1.0, 0.0, 5.0, 0.03, _SOURCE),)


def compute_output(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """Return the scaled thrust. [N]"""
    (factor,) = p
    return factor * value


EFFECT = ActuatorEffect('thrust_scale', SHARED, (), compute_output)
