"""Compute forecast errors of each model over all pieces of a flight."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_discovery.finding import ChannelErrors
from lta_discovery.flights.measured_flight import CHANNELS, PERIOD
from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.forecast.held_out import summarize_residuals, WHOLE
from lta_discovery.forecast.horizon_errors import HORIZONS
from lta_discovery.forecast.prediction_errors import extrapolate_coast
from lta_discovery.forecast.prediction_errors import HORIZONS as TOLD
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_logarithm,
    quaternion_product,
)
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.transfer.online_lift import piece_start_times, subtract_online_lift
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

POSE: Final = CHANNELS[:6]


def coast_errors(flight: FlightLinearizer, horizons: Sequence[float] = HORIZONS) -> Array:
    """Return the errors of constant body velocity and rates, shape (S, H, 6)."""
    cut, measured = flight.replay.cut, flight.replay.flight
    at = np.rint(np.array(horizons) / PERIOD).astype(np.int64)
    # In the frame of the tracker, as nothing of the model is used
    states = extrapolate_coast(cut.start, cut.length)[:, at]
    index = flight.index[:, at]
    turn = quaternion_logarithm(
        quaternion_product(quaternion_conjugate(states[..., 3:7]), measured.quaternion[index])
    )
    left = np.concatenate([measured.position[index] - states[..., :3], turn], axis=-1)
    left[~cut.inside[:, at]] = np.nan
    return left


def forecast_errors(sight: ForecastFitter, values: Array, flights: Sequence[int]) -> Array:
    """Return forecast errors, shape (S, H, 6), with the lift estimated from earlier pieces."""
    return np.concatenate(
        [
            subtract_online_lift(
                sight.compute_flight_errors(values, f),
                piece_start_times(sight.flights[f]),
                sight.lift,
            )
            for f in flights
        ]
    )


def compute_pose_errors(
    sight: ForecastFitter, models: Mapping[str, Array], seed: int
) -> list[ChannelErrors]:
    """
    Return the errors of each model: position and attitude, then by channel, at each horizon.

    `models`, shape (G,): parameters of 'before', 'tuned', 'after' and optionally 'refitted'.
    """
    every = range(len(sight.flights))
    offs = {kind: forecast_errors(sight, values, every) for kind, values in models.items()}
    offs['coast'] = np.concatenate([coast_errors(flight) for flight in sight.flights])
    at = [HORIZONS.index(horizon) for horizon in TOLD]
    at_horizons = {kind: off[:, at] for kind, off in offs.items()}
    return summarize_residuals(sight.flights, at_horizons, seed, (*WHOLE, *POSE))
