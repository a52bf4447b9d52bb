# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Judge a calibration by forecasts: as a whole, and each of its corrections taken back.

The forecasts without an effect show what it is worth: values that are clear in the readings may
still improve no forecast, as those of a fit that follows an error of the model.
"""

from collections.abc import Callable, Mapping, Sequence

from lta_discovery.calibration.prepared_flights import PreparedCalibration
from lta_discovery.calibration.result import (
    CalibratedValue,
    Correction,
    JudgedCorrection,
    WIDE,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import apply_parameters, FreeParameter
from lta_discovery.settings import WORSE
from lta_discovery.state_filter.forecast_scores import (
    CALIBRATED,
    compare_errors,
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
from numpy.typing import NDArray

Array = NDArray[np.float64]

GAINS, COUPLING = 'wrench_gain', 'wrench_coupling'


def list_corrections(
    nominal: NominalVehicle,
    parameters: Sequence[FreeParameter],
    change: Array,
    covariance: Array,
    values: Sequence[CalibratedValue],
) -> tuple[Correction, ...]:
    """
    Return the effects of which a calibration changed a value clearly.

    Parameters
    ----------
    nominal : NominalVehicle
        Of the vehicle file.
    change, covariance : (K,), (K, K) arrays
        Calibrated values of the parameters relative to the file; 0 for what only flights have.
    values : sequence of CalibratedValue
        Those of the vehicle, in the units of the file.

    """
    effects = [classify_value(one.name) for one in parameters]
    out = []
    for effect in dict.fromkeys(effects):
        clear = [one for one in values if classify_value(one.name) == effect and is_clear(one)]
        back = np.array([one == effect for one in effects])
        if clear and np.any(change[back]):
            most_probable = _condition(change, covariance, back)
            without = apply_parameters(nominal, parameters, most_probable)[0]
            out.append(Correction(effect, tuple(clear), without))
    return tuple(out)


def judge_corrections(
    corrections: Sequence[Correction],
    calibrated: Sequence[FlightForecasts],
    forecast: Callable[[Mapping[str, NominalVehicle]], Mapping[str, Sequence[FlightForecasts]]],
) -> tuple[JudgedCorrection, ...]:
    """
    Return what each correction of a calibration is worth, the most useful first.

    `calibrated`: forecasts of some flights by the calibrated vehicle. `forecast`: forecasts these
    flights by other vehicles, by name.
    """
    others = forecast({one.effect: one.without for one in corrections}) if corrections else {}
    worth = [
        JudgedCorrection(one, compare_errors(calibrated, others[one.effect]))
        for one in corrections
    ]
    return tuple(sorted(worth, key=lambda one: one.ratio.value))


def classify_value(name: str) -> str:
    """Return the effect of a parameter; what commands do on other axes is one of its own."""
    effect, _, part = name.partition('.')
    return COUPLING if effect == GAINS and '_from_' in part else effect


def is_clear(one: CalibratedValue) -> bool:
    """Return whether the value of the file is outside the interval of a value that was learned."""
    return one.is_known and abs(one.value - one.before) > WIDE * one.deviation


def _condition(change: Array, covariance: Array, back: NDArray[np.bool_]) -> Array:
    """Return the most probable values if some of them are 0."""
    out = np.where(back, 0.0, change)
    # What only flights have stays as it is
    rest = ~back & (change != 0.0)
    gain = np.linalg.lstsq(covariance[np.ix_(back, back)], change[back], rcond=None)[0]
    out[rest] -= covariance[np.ix_(rest, back)] @ gain
    return out


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
