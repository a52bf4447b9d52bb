"""
Thrust that decreases with the battery voltage.

    u' = u max(0, 1 + sensitivity (V / voltage - 1))

A brushed motor under pulse-width modulation sees the mean voltage V u, so a thrust curve measured
against duty at one battery voltage holds at another with u' = u V / voltage: a sensitivity of 1.
V is the voltage under load from the surroundings; if it is unknown (0), or the nominal `voltage`
is 0, nothing changes.

The sensitivity is d ln u' / d ln V at the nominal voltage. In Crazyflie flights force per duty
goes with V^0.7; with a thrust curve of T ~ u^1.45 near hover that is a sensitivity of 0.5. Linear
instead of a power: within 20 % of the nominal voltage and for sensitivities up to 1 they differ by
at most 0.7 %, and no call of pow is needed.

Applied before the lag: a rotor follows the voltage as slowly as the duty.
"""

from lta_model.effects.protocol import ActuatorEffect, EffectParameter, Values
from lta_model.state import VOLTAGE

_NOMINAL = (
    'a lithium cell has 3.0 to 4.2 V (Crazyflie firmware: critical at 3.0 V); limit: 14 cells'
)
_SENSITIVITY = (
    '1: thrust by the mean voltage; in Crazyflie flights, force per duty goes with V^0.6 to V^0.7'
)

SHARED = (
    EffectParameter('voltage', 'V', 0.0, 0.0, 60.0, 0.1, _NOMINAL, beside=3.7),
    EffectParameter('sensitivity', '1', 1.0, 0.0, 2.0, 0.3, _SENSITIVITY),
)


def compute_output(p: Values, memory: Values, value: float, surroundings: Values) -> float:
    """Return the equivalent duty at the nominal voltage."""
    voltage, sensitivity = p
    present = surroundings[VOLTAGE]
    # A voltage of 0 means unknown, a nominal one of 0 means off
    if voltage > 0.0 and present > 0.0:
        return value * max(0.0, 1.0 + sensitivity * (present / voltage - 1.0))
    return value


EFFECT = ActuatorEffect('battery_sag', SHARED, (), compute_output)
