"""
How well a signal follows what was asked for.

With e = asked - flown on the judged stretch, its last quarter being the end:

    overshoot       greatest excess over the goal of a step, as a share of the step
    settling time   from when the error never leaves the band again; NaN if it does not settle
    steady error    mean of e over the end
    rms             root mean square of e over the whole stretch
    ripple          standard deviation of e over the end
    held            settled, and before the end began
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
END = 0.75  # of the stretch, where its last quarter begins


class TrackingMetrics(NamedTuple):
    """Figures of one signal, in its unit and seconds; the overshoot is a share, NaN for ramps."""

    overshoot: float
    settling_time: float
    steady_error: float
    rms: float
    ripple: float
    held: bool


def compute_metrics(
    time: Array, setpoint: Array, response: Array, band: float, before: float
) -> TrackingMetrics:
    """
    Return the figures of a stretch.

    Parameters
    ----------
    time, asked, flown : ndarray, shape (n,)
        The stretch, n > 1; angles unwrapped.
    band : float
        Largest error that counts as settled, in the unit of the signal.
    before : float
        What was asked for before it began: the step is from there; equal, there is none.

    """
    error = setpoint - response
    begin, end = float(time[0]), float(time[-1])
    last = time >= begin + END * (end - begin)
    outside = np.flatnonzero(~(np.abs(error) <= band))
    if not len(outside):
        settling = 0.0
    elif outside[-1] + 1 == len(time):
        settling = math.nan
    else:
        settling = float(time[outside[-1] + 1]) - begin
    step = float(setpoint[-1]) - before
    constant = bool(np.all(setpoint == setpoint[0]))
    excess = math.copysign(1.0, step) * (response - setpoint)
    overshoot = max(0.0, float(excess.max())) / abs(step) if constant and step else math.nan
    return TrackingMetrics(
        overshoot,
        settling,
        float(error[last].mean()),
        math.sqrt(float(np.mean(error**2))),
        float(error[last].std()),
        bool(settling <= END * (end - begin)),
    )
