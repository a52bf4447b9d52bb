"""
Common factor on the thrust of all rotors.

    T' = factor T

It covers another batch of motors or another air density: at a given rotor speed thrust goes with
the density, 6 % less at 600 m above the sea (standard atmosphere) or in air 20 K warmer
(293 K / 313 K).
"""

from lta_model.effects.protocol import ActuatorEffect, EffectParameter, Values

_SOURCE = (
    'Bitcraze 2015: its bench data deviate by 3 mN rms (of up to 142 mN) from the firmware curve'
)

SHARED = (EffectParameter('factor', '1', 1.0, 0.0, 5.0, 0.03, _SOURCE),)


def compute_output(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """Return the scaled thrust. [N]"""
    (factor,) = p
    return factor * value


EFFECT = ActuatorEffect('thrust_scale', SHARED, (), compute_output)
