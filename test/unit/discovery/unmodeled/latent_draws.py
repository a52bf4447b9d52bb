"""Latent forces that were drawn: a turning vehicle, and air that forgets itself."""

from lta_discovery.fit.evidence import MEMORY
from lta_discovery.unmodeled.latent_series import LatentSeries
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEP = 6.0 / 19.0  # s; of 20 knots in a piece


def process(rng: np.random.Generator, count: int, width: int, memory: float = MEMORY) -> Array:
    """Return Ornstein-Uhlenbeck processes of deviation 1 at knots, shape (count, width)."""
    kept = np.exp(-STEP / memory)
    fresh = rng.standard_normal((count, width)) * np.sqrt(1.0 - kept**2)
    out = np.empty((count, width))
    out[0] = rng.standard_normal(width)
    for k in range(1, count):
        out[k] = kept * out[k - 1] + fresh[k]
    return out


def times(seconds: float) -> Array:
    """Return the times of the knots of a flight. [s]"""
    return np.arange(round(seconds / STEP) + 1) * STEP


def turning(ground: Array, moments: Array, rate: float = 0.5) -> LatentSeries:
    """Return the series of a vehicle that turns at a rate and feels a force of the map. [rad/s]"""
    time = np.arange(len(ground)) * STEP
    c, s = np.cos(rate * time), np.sin(rate * time)
    x, y, z = ground.T
    return LatentSeries(time, ground, np.column_stack([c * x + s * y, c * y - s * x, z, moments]))
