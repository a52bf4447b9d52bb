"""
Rotors that obey the command of a while ago.

    t' = t - delay

Radio, scheduler and motor driver together: at flight time t the rotors obey what was commanded for
t - delay. A dead time, where `motor_lag` is a first-order lag after it.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

_SOURCE = 'prior assumed: one period of control at 100 Hz; a second is a lost link'

PARAMETERS = (EffectParameter('delay', 's', 0.0, 0.0, 1.0, 0.01, _SOURCE),)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the flight time of the command that the rotors obey now. [s]"""
    (delay,) = p
    return (values[0] - delay,)


EFFECT = MeasurementEffect('command_delay', PARAMETERS, 'command_time', compute_reading)
