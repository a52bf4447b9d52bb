"""
Constant offset of the range finder.

    d_read = d + offset

It adds to the offset drawn for each flight. A sensor mounted lower or higher than in its vehicle
file reads the same.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

# The spread is that of a uniform draw within the manual's bound, 20 mm / 3^0.5.
_SOURCE = 'ST VL53L1X manual: error of +-20 mm in the dark; limits assumed'

PARAMETERS = (EffectParameter('offset', 'm', 0.0, -0.5, 0.5, 0.012, _SOURCE),)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the distance with its offset. [m]"""
    (offset,) = p
    return (values[0] + offset,)


EFFECT = MeasurementEffect('range_offset', PARAMETERS, 'range', compute_reading)
