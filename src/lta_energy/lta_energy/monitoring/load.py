"""
Smooth the power drawn from the cell, and estimate the uncertainty of its mean.

Two first-order filters in series: the quick one follows the present load, the slow one is the mean
used for forecasts. If the quick one is an Ornstein-Uhlenbeck process of correlation time T1 and
variance v, its mean over T2 has the variance v T1 / (T1 + T2).
"""

import math
from typing import NamedTuple


class LoadEstimate(NamedTuple):
    """Quick and slow mean [W], variance of the quick about the slow one [W2], age [s]."""

    quick: float = 0.0
    mean: float = 0.0
    variance: float = 0.0
    age: float = 0.0


def initial_load(power: float) -> LoadEstimate:
    """Return the load after one reading [W], with the power itself as its standard deviation."""
    return LoadEstimate(power, power, power * power)


def update_load(
    before: LoadEstimate, power: float, dt: float, quick: float, slow: float
) -> LoadEstimate:
    """
    Update the load with a new power.

    `power`: power drawn from the cell [W]. `dt`: time since the last update [s]. `quick`, `slow`:
    time constants; 0 disables the filter [s].
    """
    age = before.age + dt
    now = before.quick + _smoothing_weight(dt, quick, age) * (power - before.quick)
    share = _smoothing_weight(dt, slow, age)
    # Exponentially weighted variance of the quick mean about the slow one
    off = now - before.mean
    return LoadEstimate(
        now,
        before.mean + share * off,
        (1.0 - share) * (before.variance + share * off * off),
        age,
    )


def mean_load_deviation(load: LoadEstimate, quick: float, slow: float) -> float:
    """Return the standard deviation of the mean load. [W]"""
    # T1 / (T1 + T2), with the age in place of T2 while the mean is young
    span = min(slow, load.age)
    share = quick / (quick + span) if quick + span > 0.0 else 1.0
    return math.sqrt(load.variance * share)


def _smoothing_weight(dt: float, time: float, age: float) -> float:
    """Return the weight of the newest value: exponential, or that of a plain mean while young."""
    # dt / age makes a plain mean of the first values, so that the first reading does not linger
    return max(-math.expm1(-dt / time), dt / age) if time > 0.0 and age > 0.0 else 1.0
