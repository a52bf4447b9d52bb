"""Prediction errors of one flight at one point, computed apart from the study's own."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final, Literal

from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.forecast.prediction_errors import extrapolate_coast, HORIZONS
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_logarithm,
    quaternion_product,
)
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import predict_readings, transform_to_map
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
What = Literal['position', 'attitude']


@final
@dataclass(frozen=True, slots=True)
class ErrorStatistics:
    """Prediction errors at one horizon."""

    mean: float  # root mean square of the distance [m] or angle [rad] over all pieces
    median: float
    pieces: int


@final
@dataclass(frozen=True, slots=True)
class PredictionErrors:
    """Prediction errors of one flight and one set of parameters."""

    # Of 'position' [m] and 'attitude' [rad], by horizon [s]
    model: Mapping[tuple[What, float], ErrorStatistics]
    coast: Mapping[tuple[What, float], ErrorStatistics]
    noise: Mapping[What, float]  # of the tracker: the lower limit of any model's error


def _summarize_errors(off: Mapping[What, Array]) -> dict[tuple[What, float], ErrorStatistics]:
    """Return the statistics at each horizon from the errors of each piece and point."""
    out: dict[tuple[What, float], ErrorStatistics] = {}
    for what, sizes in off.items():
        for horizon in HORIZONS:
            index = round(horizon / PERIOD)
            if index >= sizes.shape[1]:
                continue
            known = sizes[:, index][np.isfinite(sizes[:, index])]
            if len(known):
                mean = float(np.sqrt(np.mean(known**2)))
                out[what, horizon] = ErrorStatistics(mean, float(np.median(known)), len(known))
    return out


def compute_prediction_errors(
    flight: FlightLinearizer, point: LinearizationPoint
) -> PredictionErrors:
    """Compute the prediction errors of a model on one flight, without corrections on the way."""
    replay = flight.replay
    rows = replay.build_replay_rows(point.nominal)
    still = LinearizationPoint(point.nominal, point.values, np.zeros_like(point.random))
    predicted = flight.simulate_forecast(still)[:, ::STEPS]
    coast = extrapolate_coast(transform_to_map(replay.cut.start, rows.acting), replay.cut.length)
    offs = []
    for states in (predicted, coast):
        said = predict_readings(states, flight.time, rows.acting, flight.places)
        turn = quaternion_logarithm(
            quaternion_product(
                quaternion_conjugate(said.quaternion), replay.flight.quaternion[flight.index]
            )
        )
        way = replay.flight.position[flight.index] - said.position
        off: dict[What, Array] = {
            'position': np.linalg.norm(way, axis=-1),
            'attitude': np.linalg.norm(turn, axis=-1),
        }
        # Points outside of the usable part of a piece
        for sizes in off.values():
            sizes[~replay.cut.inside] = np.nan
        offs.append(_summarize_errors(off))
    noise: dict[What, float] = {
        'position': float(np.linalg.norm(replay.flight.reading_deviation[:3])),
        'attitude': float(np.linalg.norm(replay.flight.reading_deviation[3:6])),
    }
    return PredictionErrors(offs[0], offs[1], noise)
