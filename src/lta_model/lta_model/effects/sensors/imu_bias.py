"""
Constant bias of each accelerometer axis.

    f_read = f + (x, y, z)

It adds to the offset drawn for each flight, before noise, rounding and clipping, and is the same
in every flight, so that identification can estimate it.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

# The spread is that of a uniform draw within the data sheet's bound, 20 mg / 3^0.5.
_SOURCE = 'Bosch BMI088 data sheet: zero-g offset of +-20 mg; limits: ten times that (assumed)'

PARAMETERS = (
    EffectParameter('x', 'm/s2', 0.0, -2.0, 2.0, 0.11, _SOURCE),
    EffectParameter('y', 'm/s2', 0.0, -2.0, 2.0, 0.11, _SOURCE),
    EffectParameter('z', 'm/s2', 0.0, -2.0, 2.0, 0.11, _SOURCE),
)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the specific force with its bias, body frame. [m/s2]"""
    x, y, z = p
    return (values[0] + x, values[1] + y, values[2] + z)


EFFECT = MeasurementEffect('imu_bias', PARAMETERS, 'force', compute_reading)
