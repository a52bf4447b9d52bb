"""
The vehicle's clock is ahead of the tracker's by a constant.

    clock(t) = t + offset,   t the tracker's time

Only the difference of two clocks shows. The graph's time is the vehicle's, because every stamp of
the vehicle is a key of the lockstep; so the tracker's side moves: what it stamps t is the pose of
the vehicle's time t + offset (`lta_sim.tracker`). A positive offset shows the vehicle's sensors
late and the tracker early.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

_SOURCE = 'assumed: two computers on one network without a common time service'

PARAMETERS = (EffectParameter('offset', 's', 0.0, -0.5, 0.5, 0.05, _SOURCE),)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the time of the vehicle's clock. [s]"""
    (offset,) = p
    return (values[0] + offset,)


EFFECT = MeasurementEffect('clock_offset', PARAMETERS, 'clock', compute_reading)
