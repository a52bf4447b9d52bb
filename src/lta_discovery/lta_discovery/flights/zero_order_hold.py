"""Average signals that are held until the next sample, such as commands."""

from lta_discovery.flights.measured_flight import Stream
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def average_held_values(stream: Stream, edges: Array) -> Array:
    """
    Return the mean of a held signal over each interval, shape (n, k).

    The signal is 0 before its first sample. There are n + 1 rising edges.
    """
    # Each value is held until the next sample
    apart = np.diff(stream.time)[:, None] * stream.values[:-1]
    total = np.vstack([np.zeros((1, stream.values.shape[1])), np.cumsum(apart, axis=0)])
    # -1 before the first sample
    newest = np.searchsorted(stream.time, edges, side='right') - 1
    begun = newest >= 0
    at = np.where(begun, newest, 0)
    since = np.where(begun, edges - stream.time[at], 0.0)
    integral = total[at] + since[:, None] * stream.values[at]
    # Differences of the running integral are exact for a held signal
    means: Array = np.diff(integral, axis=0) / np.diff(edges)[:, None]
    return means
