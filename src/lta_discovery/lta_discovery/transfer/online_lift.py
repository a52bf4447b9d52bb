"""Correct forecasts by a lift estimated from earlier pieces of the flight."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.forecast.horizon_errors import HorizonErrors, HORIZONS
from lta_discovery.replay.flight_linearizer import FlightLinearizer
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIZE: Final = 0.05  # m per second ahead: position error due to the initial state


def piece_start_times(flight: FlightLinearizer) -> Array:
    """Return the time of each piece's beginning, shape (S,). [s]"""
    started: Array = flight.replay.flight.time[flight.replay.cut.first]
    return started


def subtract_online_lift(
    ahead: HorizonErrors, time: Array, lift: float, horizons: Sequence[float] = HORIZONS
) -> Array:
    """
    Subtract the error of the lift that earlier pieces make most probable.

    `ahead`: its last column is the sensitivity to the lift. The result has shape (S, H, 6): NaN
    where unknown [m, rad].
    """
    left, column = ahead.errors, ahead.columns[..., -1]
    ends = time[:, None] + np.array(horizons)
    finite = np.isfinite(left).all(axis=-1)
    out = left.copy()
    for k, now in enumerate(time):
        # Only forecasts that have ended by now: a real-time estimator knows no more.
        over = (ends <= now + 1e-6) & finite
        size = (SIZE * np.broadcast_to(np.array(horizons), over.shape)[over])[:, None]
        # Errors grow with the horizon, so later ones weigh less
        a, r = column[over][:, :3] / size, left[over][:, :3] / size
        out[k] -= column[k] * (np.sum(a * r) / (np.sum(a * a) + lift**-2.0))
    return out
