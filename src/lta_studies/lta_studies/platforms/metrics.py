"""
Compute how well a signal follows its setpoint.

With e = setpoint - response on the rated interval:

    overshoot       largest excess over the goal of a step, as a share of the step
    settling time   after which the error stays within the band; NaN if it does not settle
    steady error    mean of e over the last quarter
    rms             root mean square of e over the whole interval
    ripple          standard deviation of e over the last quarter
    held            settled before the last quarter
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
END = 0.75  # share of the interval after which its last quarter begins


class TrackingMetrics(NamedTuple):
    """Metrics of one signal, in its unit and s; the overshoot is a share, NaN for ramps."""

    overshoot: float
    settling_time: float
    steady_error: float
    rms: float
    ripple: float
    held: bool


def compute_tracking_metrics(
    time: Array, setpoint: Array, response: Array, band: float, before: float
) -> TrackingMetrics:
    """
    Compute the metrics of a signal.

    `time`, `setpoint`, `response`, shape (n,): the rated interval, n > 1; angles unwrapped.
    `band`: largest error that counts as settled, in the unit of the signal. `before`: setpoint
    before the interval, where the step starts; there is no step if it is equal.
    """
    error = setpoint - response
    begin, end = float(time[0]), float(time[-1])
    last = time >= begin + END * (end - begin)
    outside = np.flatnonzero(~(np.abs(error) <= band))  # NaN counts as outside
    if not len(outside):
        settling = 0.0
    elif outside[-1] + 1 == len(time):
        settling = math.nan
    else:
        settling = float(time[outside[-1] + 1]) - begin
    step = float(setpoint[-1]) - before
    constant = bool(np.all(setpoint == setpoint[0]))
    # Positive beyond the goal, for steps up and down.
    excess = math.copysign(1.0, step) * (response - setpoint)
    overshoot = max(0.0, float(excess.max())) / abs(step) if constant and step else math.nan
    return TrackingMetrics(
        overshoot,
        settling,
        float(error[last].mean()),
        math.sqrt(float(np.mean(error**2))),
        float(error[last].std()),
        # A NaN settling time compares as False: not held.
        bool(settling <= END * (end - begin)),
    )
