"""
Scale factor of each gyroscope axis.

    w_read = (x w_x, y w_y, z w_z)

A heading integrated from rates errs by (z - 1) times the angle turned.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

# The spread is that of a uniform draw within the data sheet's bound, 1 % / 3^0.5.
_SOURCE = 'Bosch BMI088 data sheet: sensitivity within +-1 %; limits: 20 % (assumed)'

PARAMETERS = (
    EffectParameter('x', '1', 1.0, 0.8, 1.2, 0.006, _SOURCE),
    EffectParameter('y', '1', 1.0, 0.8, 1.2, 0.006, _SOURCE),
    EffectParameter('z', '1', 1.0, 0.8, 1.2, 0.006, _SOURCE),
)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the rates as the gyroscope scales them, body frame. [rad/s]"""
    x, y, z = p
    return (x * values[0], y * values[1], z * values[2])


EFFECT = MeasurementEffect('gyro_scale', PARAMETERS, 'rates', compute_reading)
