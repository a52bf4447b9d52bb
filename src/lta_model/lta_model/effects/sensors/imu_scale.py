"""
Scale factor of each accelerometer axis.

    f_read = (x f_x, y f_y, z f_z)
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

# The data sheet bounds the scale of the gyroscope only; that of the accelerometer is taken alike
_SOURCE = 'assumed: as the gyroscope, Bosch BMI088 data sheet: sensitivity within +-1 %'

PARAMETERS = (
    EffectParameter('x', '1', 1.0, 0.8, 1.2, 0.006, _SOURCE),
    EffectParameter('y', '1', 1.0, 0.8, 1.2, 0.006, _SOURCE),
    EffectParameter('z', '1', 1.0, 0.8, 1.2, 0.006, _SOURCE),
)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the specific force as the accelerometer scales it, body frame. [m/s2]"""
    x, y, z = p
    return (x * values[0], y * values[1], z * values[2])


EFFECT = MeasurementEffect('imu_scale', PARAMETERS, 'force', compute_reading)
