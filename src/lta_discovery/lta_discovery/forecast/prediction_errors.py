"""Predict a flight without a model: the reference that keeps the initial body velocity."""

from typing import Final

from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.model.quaternions import (
    quaternion_exponential,
    quaternion_product,
    rotate_vectors,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HORIZONS: Final = (1.0, 2.0, 3.0, 5.0)  # s


def extrapolate_coast(start: Array, count: int) -> Array:
    """
    Extrapolate states with constant body velocity and rates, shape (S, count + 1, 13).

    The velocity turns with the body: a circle, not a straight line.
    """
    out = np.repeat(start[:, None], count + 1, axis=1)
    for k in range(count):
        now = out[:, k]
        # Midpoint rule: move along the attitude in the middle of the period.
        half = quaternion_product(
            now[:, 3:7], quaternion_exponential(0.5 * PERIOD * now[:, 10:13])
        )
        out[:, k + 1, :3] = now[:, :3] + PERIOD * rotate_vectors(half, now[:, 7:10])
        out[:, k + 1, 3:7] = quaternion_product(
            now[:, 3:7], quaternion_exponential(PERIOD * now[:, 10:13])
        )
    return out
