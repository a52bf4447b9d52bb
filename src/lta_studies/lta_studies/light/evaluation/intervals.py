"""Compute means with 95 % bootstrap intervals, without assuming a distribution."""

from collections.abc import Sequence
import math
from typing import Final, NamedTuple

import numpy as np

DRAWS: Final = 4000
SEED: Final = 7
ENDS: Final = (2.5, 97.5)  # %


class BootstrapMean(NamedTuple):
    """A mean, or a ratio of means, with its 95 % interval and number of flights."""

    value: float
    low: float
    high: float
    flights: int


def bootstrap_mean(values: Sequence[float]) -> BootstrapMean:
    """
    Return a mean with its percentile bootstrap interval.

    Efron and Tibshirani, An Introduction to the Bootstrap (1993), chapter 13. NaN without values;
    a single value has no interval.
    """
    # A mean is a ratio with the denominator 1.
    return bootstrap_ratio(values, [1.0] * len(values))


def bootstrap_ratio(above: Sequence[float], below: Sequence[float]) -> BootstrapMean:
    """Return the ratio of two means over the same flights, resampled in pairs."""
    count = len(above)
    if count == 0:
        return BootstrapMean(math.nan, math.nan, math.nan, 0)
    top, bottom = np.array(above, dtype=np.float64), np.array(below, dtype=np.float64)
    value = float(top.mean() / bottom.mean())
    # Resampling one value would give an interval of zero width.
    if count == 1:
        return BootstrapMean(value, math.nan, math.nan, 1)
    # A fixed seed makes the page reproducible.
    resamples = np.random.default_rng(SEED).integers(count, size=(DRAWS, count))
    low, high = np.percentile(top[resamples].mean(axis=1) / bottom[resamples].mean(axis=1), ENDS)
    return BootstrapMean(value, float(low), float(high), count)
