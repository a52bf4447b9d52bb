"""
Rate error of the vehicle's clock relative to the tracker's.

    clock(t) = t (1 + skew),   t the tracker's time since the start of the flight

The error is zero at the start; `clock_offset` is the constant part, and explains why the tracker's
side is shifted.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

_SOURCE = 'clock crystals are accurate to about 50 ppm (unverified, from memory); limits assumed'

PARAMETERS = (EffectParameter('skew', '1', 0.0, -1e-3, 1e-3, 3e-5, _SOURCE),)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the time of the vehicle's clock. [s]"""
    (skew,) = p
    return (values[0] + skew * time,)


EFFECT = MeasurementEffect('clock_skew', PARAMETERS, 'clock', compute_reading)
