"""
Rotors that have lost part of their thrust.

    T_i' = (1 - lost_i) T_i

A chipped propeller, a worn motor, a hair around the shaft; lost_i = 1 is a stopped rotor. Not
modelled: vibration and the changed power of a damaged propeller.
"""

from lta_model.effects.protocol import ActuatorEffect, EffectParameter, Values

_SOURCE = (
    'limits: intact (0) and standing still (1); spread: two motors of one batch differ by 2 % '
    '(assumed)'
)

EACH = (EffectParameter('lost', '1', 0.0, 0.0, 1.0, 0.02, _SOURCE),)


def compute_output(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """Return the remaining thrust. [N]"""
    (lost,) = p
    return (1.0 - lost) * value


EFFECT = ActuatorEffect('rotor_fault', (), EACH, compute_output)
