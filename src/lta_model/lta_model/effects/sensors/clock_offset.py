"""
Constant offset of the vehicle's clock from the tracker's.

    clock(t) = t + offset,   t the tracker's time

Only the difference of the clocks is observable. The graph runs on the vehicle's time, which keys
the lockstep, so the tracker's side is shifted: its stamp t carries the pose of the vehicle's time
t + offset (`lta_sim.tracker`). With a positive offset the vehicle's sensors appear late and the
tracker early.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

_SOURCE = 'assumed: two computers in one network without time synchronisation'

PARAMETERS = (EffectParameter('offset', 's', 0.0, -0.5, 0.5, 0.05, _SOURCE),)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the time of the vehicle's clock. [s]"""
    (offset,) = p
    return (values[0] + offset,)


EFFECT = MeasurementEffect('clock_offset', PARAMETERS, 'clock', compute_reading)
