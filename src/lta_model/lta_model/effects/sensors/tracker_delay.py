"""
Uncompensated latency of the tracker: exposure, image processing and network.

    t' = t - delay

A pose stamped t is the true pose of t'. Between control steps the truth is interpolated
(`lta_sim.tracker`); before the start it is the start pose.
"""

from lta_model.effects.protocol import EffectParameter, MeasurementEffect, Values

_SOURCE = (
    'spread (assumed): two frames of a 100 Hz tracker; limit: cameras on a robot reach 0.1 s '
    'and more'
)

PARAMETERS = (EffectParameter('delay', 's', 0.0, 0.0, 1.0, 0.02, _SOURCE),)


def compute_reading(p: Values, values: Values, time: float) -> Values:
    """Return the flight time at which the reported pose was true. [s]"""
    (delay,) = p
    return (values[0] - delay,)


EFFECT = MeasurementEffect('tracker_delay', PARAMETERS, 'pose_time', compute_reading)
