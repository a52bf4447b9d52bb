"""Score a calibration by its forecasts, beside the vehicle file and coasting."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_discovery.calibration.prepared_flights import PreparedCalibration
from lta_discovery.calibration.result import ForecastRms, ForecastScore
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.state_filter.forecasts import (
    FlightForecasts,
    forecast_flights,
    list_flight_parameters,
)
from lta_discovery.state_filter.noise_model import NoiseModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Of the position error of a file; another file with more is not advised, and a calibration with
# more on confirming flights is contradicted
WORSE: Final = 1.05


def forecast_role(
    prepared: PreparedCalibration, role: str, nominal: NominalVehicle, noise: NoiseModel
) -> list[FlightForecasts]:
    """Return the forecasts of the flights of a role with a vehicle."""
    flights = prepared.flights[role]
    own = list_flight_parameters(nominal, prepared.parameters)
    noises = [noise] * len(flights)
    return forecast_flights(prepared.vehicle, nominal, flights, own, noises, prepared.horizons)


def score_forecasts(
    before: Sequence[FlightForecasts], after: Sequence[FlightForecasts]
) -> tuple[ForecastScore, ...]:
    """Return the errors of two models of the same flights at each horizon that was reached."""
    out = []
    horizons = before[0].horizons if before else ()
    for h, horizon in enumerate(horizons):
        coast = np.concatenate([one.coasting[:, h] for one in after])
        headings = np.concatenate([one.headings for one in after])
        both = [np.concatenate([one.errors[:, h] for one in each]) for each in (before, after)]
        tables = np.stack([coast, *both])
        measured = ~np.isnan(tables).any(axis=(0, 2))
        if measured.any():
            rms = [summarize_errors(one[measured], headings[measured]) for one in tables]
            out.append(ForecastScore(horizon, rms[0], rms[1], rms[2], int(measured.sum())))
    return tuple(out)


def summarize_errors(errors: Array, headings: Array) -> ForecastRms:
    """
    Return RMS errors; infinite where a forecast diverged.

    `errors`: of poses, shape (N, 6). `headings`: in which the forecasts begin, shape (N,).
    """
    nose = np.column_stack([np.cos(headings), np.sin(headings)])
    side = np.column_stack([-nose[:, 1], nose[:, 0]])
    with np.errstate(over='ignore', invalid='ignore'):
        parts = (
            np.linalg.norm(errors[:, :3], axis=1),
            np.linalg.norm(errors[:, 3:], axis=1),
            np.sum(errors[:, :2] * nose, axis=1),
            np.sum(errors[:, :2] * side, axis=1),
            errors[:, 2],
        )
        sizes = (np.where(np.isfinite(one), one, np.inf) for one in parts)
        return ForecastRms(*(float(np.sqrt(np.mean(one**2))) for one in sizes))


def relative_error(scores: Sequence[ForecastScore]) -> float:
    """Return the error of a calibration relative to the file's: below 1 is better."""
    return _relative_error(scores, 2)


def relative_position_error(scores: Sequence[ForecastScore]) -> float:
    """Return the error of the positions relative to the file's: below 1 is better."""
    return _relative_error(scores, 1)


def _relative_error(scores: Sequence[ForecastScore], parts: int) -> float:
    """Return the relative error of the first parts of `ForecastRms`."""
    ratios = [
        after / max(before, 1e-9)
        for one in scores
        for after, before in zip(one.after[:parts], one.before[:parts], strict=True)
    ]
    return float(np.sqrt(np.mean(np.square(ratios)))) if ratios else 1.0


def is_contradicted(scores: Mapping[str, Sequence[ForecastScore]]) -> bool:
    """Return whether the vehicle file forecasts positions of the confirming flights better."""
    return relative_position_error(scores.get('confirm', ())) > WORSE
