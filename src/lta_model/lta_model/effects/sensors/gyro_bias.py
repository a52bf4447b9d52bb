"""
Constant bias of each gyroscope axis.

    w_read = w + (x, y, z)

Applied after `gyro_scale`, so it is the reading at rest.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

# The spread is that of a uniform draw within the data sheet's bound, 1 deg/s / 3^0.5.
_SOURCE = 'Bosch BMI088 data sheet: offset of +-1 deg/s; limits: 20 deg/s (assumed)'

PARAMETERS = (
    EffectParameter('x', 'rad/s', 0.0, -0.35, 0.35, 0.01, _SOURCE),
    EffectParameter('y', 'rad/s', 0.0, -0.35, 0.35, 0.01, _SOURCE),
    EffectParameter('z', 'rad/s', 0.0, -0.35, 0.35, 0.01, _SOURCE),
)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the rates with their bias, body frame. [rad/s]"""
    x, y, z = p
    return (values[0] + x, values[1] + y, values[2] + z)


EFFECT = MeasurementEffect('gyro_bias', PARAMETERS, 'rates', compute_reading)
