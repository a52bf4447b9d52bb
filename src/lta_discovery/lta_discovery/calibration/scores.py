# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Score a calibration by its forecasts, beside the vehicle file and coasting."""

from collections.abc import Mapping, Sequence

from lta_discovery.calibration.prepared_flights import PreparedCalibration
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.settings import WORSE
from lta_discovery.state_filter.forecast_scores import (
    CALIBRATED,
    FILE_MODEL,
    HorizonErrors,
    score_forecasts,
)
from lta_discovery.state_filter.forecasts import (
    FlightForecasts,
    forecast_flights,
    list_flight_parameters,
)
from lta_discovery.state_filter.noise_model import NoiseModel
import numpy as np


def forecast_role(
    prepared: PreparedCalibration, role: str, nominal: NominalVehicle, noise: NoiseModel
) -> list[FlightForecasts]:
    """Return the forecasts of the flights of a role with a vehicle."""
    flights = prepared.flights[role]
    own = list_flight_parameters(nominal, prepared.parameters)
    noises = [noise] * len(flights)
    return forecast_flights(prepared.vehicle, nominal, flights, own, noises, prepared.horizons)


def compare_with_file(
    file: Sequence[FlightForecasts], calibrated: Sequence[FlightForecasts]
) -> tuple[HorizonErrors, ...]:
    """Return the errors of the vehicle file and of a calibration of it."""
    return score_forecasts({FILE_MODEL: file, CALIBRATED: calibrated})


def relative_error(scores: Sequence[HorizonErrors]) -> float:
    """Return the error of a calibration relative to the file's: below 1 is better."""
    return _relative_error(scores, 2)


def relative_position_error(scores: Sequence[HorizonErrors]) -> float:
    """Return the error of the positions relative to the file's: below 1 is better."""
    return _relative_error(scores, 1)


def _relative_error(scores: Sequence[HorizonErrors], parts: int) -> float:
    """Return the relative error of the first parts of `ForecastRms`."""
    ratios = [
        after / max(before, 1e-9)
        for one in scores
        for after, before in zip(
            one.errors[CALIBRATED][:parts], one.errors[FILE_MODEL][:parts], strict=True
        )
    ]
    return float(np.sqrt(np.mean(np.square(ratios)))) if ratios else 1.0


def is_contradicted(scores: Mapping[str, Sequence[HorizonErrors]]) -> bool:
    """Return whether the vehicle file forecasts positions of the confirming flights better."""
    return relative_position_error(scores.get('confirm', ())) > WORSE
