"""
Share of a commanded wrench that acts on the vehicle, on each axis.

    F = gain F_command

Of vehicles whose record has commanded forces and moments in place of duties (`wrench_command`). A
gain below 1 is a loss between command and air, such as a weak battery or a wrong thrust law; a
negative one is a command in other axes than those of the body. In simulation the rotors obey
duties, and it has no influence.
"""

from lta_model.effects.protocol import AXES, EffectParameter, MeasurementEffect, Values

_SOURCE = 'spread (assumed): the thrust law of a lab that never measured its rotors'

PARAMETERS = tuple(EffectParameter(axis, '1', 1.0, -20.0, 20.0, 0.2, _SOURCE) for axis in AXES)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the wrench that acts for a command. [N, N m]"""
    surge, sway, heave, roll, pitch, yaw = p
    x, y, z, k, m, n = values
    return surge * x, sway * y, heave * z, roll * k, pitch * m, yaw * n


EFFECT = MeasurementEffect('wrench_gain', PARAMETERS, 'command_wrench', compute_reading)
