"""Forecasts with a lift that each takes from what is over when it begins."""

from typing import Final

from lta_discovery.forecast.horizon_errors import HorizonErrors, HORIZONS
from lta_discovery.replay.linearizer import FlightLinearizer
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIZE: Final = 0.05  # m for each second ahead: how much an early error says of the lift


def piece_start_times(flight: FlightLinearizer) -> Array:
    """Return when each piece begins, shape (S,). [s]"""
    started: Array = flight.replay.flight.time[flight.replay.cut.first]
    return started


def subtract_online_lift(ahead: HorizonErrors, time: Array, lift: float) -> Array:
    """
    Return errors after a lift of the flight's own that its earlier pieces make most probable.

    Parameters
    ----------
    seen : Ahead
        Errors, and how they answer to the lift: its last column.
    time : ndarray, shape (S,)
        When each piece begins. [s]
    lift : float
        Standard deviation of a flight's lift. [N]

    Returns
    -------
    ndarray, shape (S, H, 6)
        NaN where the flight does not say. [m, rad]

    """
    left, column = ahead.left, ahead.columns[..., -1]
    ends = time[:, None] + np.array(HORIZONS)
    known = np.isfinite(left).all(axis=-1)
    out = left.copy()
    for k, now in enumerate(time):
        over = (ends <= now + 1e-6) & known
        size = (SIZE * np.broadcast_to(HORIZONS, over.shape)[over])[:, None]
        a, r = column[over][:, :3] / size, left[over][:, :3] / size
        out[k] -= column[k] * (np.sum(a * r) / (np.sum(a * a) + lift**-2.0))
    return out
