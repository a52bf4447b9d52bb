"""
Dead time between a command and the rotors.

    t' = t - delay

Radio, scheduler and motor driver together: at flight time t the rotors execute the command for
t - delay. `motor_lag`, a first-order lag, comes after it.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

_SOURCE = 'spread (assumed): one control period at 100 Hz; limit: a second is a lost link'

PARAMETERS = (EffectParameter('delay', 's', 0.0, 0.0, 1.0, 0.01, _SOURCE),)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the flight time of the command that the rotors execute now. [s]"""
    (delay,) = p
    return (values[0] - delay,)


EFFECT = MeasurementEffect('command_delay', PARAMETERS, 'command_time', compute_reading)
