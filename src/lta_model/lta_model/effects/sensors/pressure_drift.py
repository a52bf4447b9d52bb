"""
Linear drift of the pressure, by weather or a warming sensor.

    p_read = p + rate t,   t since the start of the flight

12 Pa are a metre. Weather changes by some 1 hPa an hour, 0.03 Pa/s; the sensor drifts less.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

_SOURCE = (
    'BMP388: 0.75 Pa/K, warming by 5 K in ten minutes; weather: 1 hPa in an hour (both '
    'unverified, from memory); limits assumed'
)

PARAMETERS = (EffectParameter('rate', 'Pa/s', 0.0, -1.0, 1.0, 0.01, _SOURCE),)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the pressure with its drift. [Pa]"""
    (rate,) = p
    return (values[0] + rate * time,)


EFFECT = MeasurementEffect('pressure_drift', PARAMETERS, 'pressure', compute_reading)
