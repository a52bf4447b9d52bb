"""
All rotors stronger or weaker than their curve says.

    T' = factor T

What separates one motor batch or one air density from the bench: thrust goes with the density of
the air, 7 % less at 600 m above the sea (standard atmosphere, 0.943) or 20 K warmer (293/313).
"""

from lta_sim.effects.protocol import ActuatorEffect, Parameter, Values

_SOURCE = 'Bitcraze 2015: its own bench lies 3 mN rms of up to 142 mN from the firmware curve'

SHARED = (Parameter('factor', '1', 1.0, 0.0, 5.0, 0.03, _SOURCE),)


def output(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """Return the scaled thrust. [N]"""
    (factor,) = p
    return factor * value


EFFECT = ActuatorEffect('thrust_scale', SHARED, (), output)
