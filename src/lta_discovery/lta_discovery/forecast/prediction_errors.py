"""
Compute prediction errors by quantity, horizon, piece and channel.

Two references need no model: *coast* keeps the initial body velocity and rates and ignores the
commands; the other is the tracker noise. Medians complement means, which one diverging piece can
dominate.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final, Literal

from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_exponential,
    quaternion_logarithm,
    quaternion_product,
    rotate_vectors,
)
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import predict_readings, transform_to_map
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
What = Literal['position', 'attitude']

HORIZONS: Final = (1.0, 2.0, 3.0, 5.0)  # s


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
    # Beginning of each piece [s] and its RMS error by the noise, over all channels; about 1 for a
    # perfect model, shape (S, 2)
    over_time: Array
    # The same of each channel of CHANNELS over all pieces, NaN where there is none, shape (14,)
    by_channel: Array


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
    left = flight.compute_residual(predicted, still, rows) / replay.flight.noise
    begun = replay.flight.time[replay.cut.first]
    with np.errstate(invalid='ignore'):
        each = np.sqrt(_mean_square(left, (1, 2)))
        channels = np.sqrt(_mean_square(left, (0, 1)))
    noise: dict[What, float] = {
        'position': float(np.linalg.norm(replay.flight.reading_deviation[:3])),
        'attitude': float(np.linalg.norm(replay.flight.reading_deviation[3:6])),
    }
    return PredictionErrors(offs[0], offs[1], noise, np.column_stack([begun, each]), channels)


def _mean_square(values: Array, axes: tuple[int, int]) -> Array:
    """Return the mean square of the known values, NaN where there are none."""
    known = np.isfinite(values)
    total = np.sum(np.where(known, values, 0.0) ** 2, axis=axes)
    count = known.sum(axis=axes)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)
