"""
The power that goes out of the cell, smoothed, and how sure its mean is.

Two first-order filters in a row: the quick one follows what the drone does now, the slow one is
the mean that a forecast takes. If the quick one is an Ornstein-Uhlenbeck process of correlation
time T1 and variance v, its mean over T2 has the variance v T1 / (T1 + T2).
"""

import math
from typing import NamedTuple


class LoadEstimate(NamedTuple):
    """Quick and slow mean [W], variance of the quick one about the slow [W2], age [s]."""

    quick: float = 0.0
    mean: float = 0.0
    variance: float = 0.0
    age: float = 0.0


def initial_load(power: float) -> LoadEstimate:
    """Return the load after one reading: nothing is known of how it changes. [W]"""
    return LoadEstimate(power, power, power * power)


def update_load(
    before: LoadEstimate, power: float, dt: float, quick: float, slow: float
) -> LoadEstimate:
    """
    Return the load after one more reading.

    A young mean is the plain mean so far, so that the first reading does not linger.

    Parameters
    ----------
    before : Load
        As it was.
    power : float
        Out of the cell. [W]
    dt : float
        Time since. [s]
    quick, slow : float
        Time constants; 0 is none. [s]

    """
    age = before.age + dt
    now = before.quick + _smoothing_weight(dt, quick, age) * (power - before.quick)
    share = _smoothing_weight(dt, slow, age)
    off = now - before.mean
    return LoadEstimate(
        now,
        before.mean + share * off,
        (1.0 - share) * (before.variance + share * off * off),
        age,
    )


def mean_load_deviation(load: LoadEstimate, quick: float, slow: float) -> float:
    """Return the standard deviation of the mean. [W]"""
    span = min(slow, load.age)
    share = quick / (quick + span) if quick + span > 0.0 else 1.0
    return math.sqrt(load.variance * share)


def _smoothing_weight(dt: float, time: float, age: float) -> float:
    """Return the share of the newest in a mean over a time, or over all of a younger age."""
    return max(-math.expm1(-dt / time), dt / age) if time > 0.0 and age > 0.0 else 1.0
