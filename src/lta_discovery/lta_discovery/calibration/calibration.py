# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Calibrate a vehicle file from flights: values with intervals, and what cannot be separated."""

from collections.abc import Callable, Mapping, Sequence
import contextlib
from dataclasses import dataclass
import math
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.calibration.calibrated_file import state_by_duty
from lta_discovery.calibration.corrections import (
    compare_with_file,
    forecast_role,
    judge_corrections,
    list_corrections,
    relative_error,
)
from lta_discovery.calibration.prepared_flights import (
    find_index,
    fit_calibration,
    prepare_calibration,
    PreparedCalibration,
)
from lta_discovery.calibration.result import (
    CalibratedValue,
    Calibration,
    JudgedCorrection,
    WIDE,
)
from lta_discovery.calibration.verdict import pendulum_rates
from lta_discovery.flights.bags import AssignedFlight
from lta_discovery.model.calibration_parameters import (
    HEADING,
    ordinary_tolerances,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import apply_parameters, FreeParameter, NET_LIFT_FORCE
from lta_discovery.settings import (
    ALIKE_CORRELATION,
    CLEAR,
    FORECAST_FIT_RATIO,
    LEARNED_SHARE,
    STRAYED,
)
from lta_discovery.state_filter.forecast_noise import (
    adapt_noise,
    fit_forecast_noise,
    sum_forecasts,
)
from lta_discovery.state_filter.forecast_scores import (
    CALIBRATED,
    FILE_MODEL,
    find_main_score,
    HorizonErrors,
)
from lta_discovery.state_filter.likelihood import ParameterPrior
from lta_discovery.state_filter.noise_model import average_noise, NoiseModel
from lta_discovery.state_filter.parameter_fit import fit_forecasts, fit_likelihood, ParameterFit
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Progress = Callable[[str, float | None], None]

LEAST_RATE: Final = 1e-3  # rad/s; of a vehicle that does not swing back
RATE_STEP: Final = 0.1  # of a tolerance, by which a derivative of a rate is taken
MAP_DIRECTION: Final = 'the direction of the axes of the map'


@final
@dataclass(frozen=True, slots=True)
class _Estimate:
    """Values with covariance: shared, and of each flight (all parameters of it)."""

    method: str
    shared: Array
    covariance: Array
    flights: Sequence[tuple[Array, Array]]
    noise: NoiseModel  # of forecasts
    # Covariance of the shared values by this fit alone, and the values of the other one
    within: Array
    others: Array


def calibrate_flights(
    vehicle: Vehicle,
    name: str,
    flights: Sequence[AssignedFlight],
    tell: Progress,
    is_judged: bool = False,
) -> Calibration:
    """
    Calibrate a vehicle with its training flights, and score the result on all.

    `is_judged`: whether forecasts of the confirming flights judge each correction, too.
    """
    tell('preparing', 0.0)
    prepared = prepare_calibration(vehicle, flights)
    tell('fitting readings', 0.1)
    prepared, fit = fit_calibration(prepared)
    nominal, knobs = prepared.nominal, prepared.parameters
    tell('fitting forecasts', 0.6)
    estimates, fit = _list_estimates(prepared, fit)
    tell('forecasting', 0.7)
    best, built, train = _choose_estimate(prepared, estimates)
    values = _list_values(nominal, knobs, best, prepared.names['train'])
    own = [one for one in values if not one.flight]
    change, covariance = _compute_mean_change(best, knobs), best.covariance
    corrections = list_corrections(nominal, knobs, change, covariance, own)
    scores, worth = {'train': train}, tuple[JudgedCorrection, ...]()
    if prepared.flights['confirm']:
        before = forecast_role(prepared, 'confirm', nominal, estimates[-1].noise)
        after = forecast_role(prepared, 'confirm', built, best.noise)
        scores['confirm'] = compare_with_file(before, after)
        if is_judged:
            worth = judge_corrections(corrections, after, lambda others: {
                name: forecast_role(prepared, 'confirm', one, best.noise)
                for name, one in others.items()
            })  # fmt: skip
    tell('done', 1.0)
    return Calibration(
        name,
        nominal,
        built,
        _build_calibrated_vehicle(nominal, knobs, best, with_flows=False),
        (*values, *_list_free_heading(nominal, knobs)),
        scores,
        best.method,
        {role: tuple(each) for role, each in prepared.names.items()},
        noise=dict(zip(prepared.names['train'], fit.noise, strict=True)),
        corrections=corrections,
        worth=worth,
        pendulum_deviations=_find_pendulum_deviations(nominal, knobs, best),
    )


def _list_estimates(
    prepared: PreparedCalibration, fit: ParameterFit
) -> tuple[list[_Estimate], ParameterFit]:
    """
    Return the estimates in the order of preference, that of the vehicle file last.

    With them the fit to readings, which may have begun again.
    """
    systems, nominal, horizons = prepared.systems, prepared.nominal, prepared.horizons
    prior = ParameterPrior.of(prepared.parameters)

    def fit_noise(one: ParameterFit) -> list[NoiseModel]:
        return fit_forecast_noise(one.flights, one.noise, prior, horizons)

    noise, ahead = fit_noise(fit), None
    with contextlib.suppress(BadInput):
        # Where nothing explains single readings, a fit to them is a poor start
        ahead = fit_forecasts(systems, nominal, prepared.begin, fit.noise, horizons)
        cost = sum_forecasts(fit.flights, noise, prior, fit.values, horizons).cost
        if math.exp(-ahead.evidence - cost) < STRAYED:
            again = fit_likelihood(systems, nominal, ahead.values, fit.noise)
            if again.evidence > fit.evidence:
                fit, noise = again, fit_noise(again)
    out = [_build_estimate('likelihood', fit, ahead, average_noise(noise))]
    if ahead is not None:
        out.append(_build_estimate('forecasts', ahead, fit, average_noise(ahead.noise)))
    none = np.zeros(len(fit.values))
    unknown = np.diag([one.tolerance**2 for one in prepared.parameters])
    adapted = adapt_noise(systems, nominal, average_noise(fit.noise), horizons)
    members = [(none, unknown)] * len(systems)
    out.append(_Estimate('file', none, unknown, members, adapted, unknown, none))
    return out, fit


def _build_estimate(
    method: str, fit: ParameterFit, other: ParameterFit | None, noise: NoiseModel
) -> _Estimate:
    """
    Return a fit, whose intervals contain the other one where they contradict each other.

    Errors of a model make two fits differ by more than either interval says, so that the square of
    the difference is added to the variance. Of the precise one, that is what its 95 % do not
    explain: where the model is right, it differs from the other by the difference of their
    variances (Hausman, Econometrica 46, 1978).
    """
    both = _join(fit)
    for (values, spread), (others, spread_of_others) in zip(
        both, _join(other) if other else both, strict=True
    ):
        excess = (values - others) ** 2
        if method == 'likelihood':
            less_precise = np.maximum(np.diag(spread_of_others) - np.diag(spread), 0.0)
            excess = np.maximum(excess - WIDE**2 * less_precise, 0.0)
        spread[np.diag_indices_from(spread)] += excess
    (shared, covariance), *members = both
    others = other.values if other else fit.values
    return _Estimate(method, shared, covariance, members, noise, fit.covariance, others)


def _join(fit: ParameterFit) -> list[tuple[Array, Array]]:
    """Return values and covariance: the shared ones, and with what each flight has of its own."""
    own = [(fit.values + own, fit.covariance + more) for own, more in fit.own]
    return [(fit.values, fit.covariance.copy()), *own]


def _choose_estimate(
    prepared: PreparedCalibration, estimates: Sequence[_Estimate]
) -> tuple[_Estimate, NominalVehicle, tuple[HorizonErrors, ...]]:
    """
    Return the estimate that forecasts the training flights best, its vehicle and its scores.

    One of less preference has to be clearly better than all before it. None is returned that
    forecasts worse than the vehicle file, or positions at the horizon that headlines state.
    """
    nominal, limit = prepared.nominal, 1.0
    file = forecast_role(prepared, 'train', nominal, estimates[-1].noise)
    chosen = estimates[-1], nominal, compare_with_file(file, file)
    for one in estimates[:-1]:
        try:
            built = _build_calibrated_vehicle(nominal, prepared.parameters, one, with_flows=True)
            after = forecast_role(prepared, 'train', built, one.noise)
            scores = compare_with_file(file, after)
        except BadInput:
            continue
        error = relative_error(scores)
        if error < limit:
            main = find_main_score(scores)
            if main and main.positions[CALIBRATED] <= main.positions[FILE_MODEL]:
                chosen = one, built, scores
        limit = min(limit, FORECAST_FIT_RATIO * error)
    return chosen


def _build_calibrated_vehicle(
    nominal: NominalVehicle, knobs: Sequence[FreeParameter], best: _Estimate, with_flows: bool
) -> NominalVehicle:
    """Return the vehicle with the calibrated values and the mean net lift of the flights."""
    mean = _compute_mean_change(best, knobs)
    if not with_flows:
        mean[[not knob.is_calibration for knob in knobs]] = 0.0
    return apply_parameters(nominal, knobs, mean)[0]


def _compute_mean_change(best: _Estimate, knobs: Sequence[FreeParameter]) -> Array:
    """Return the values of the vehicle, with the mean net lift of the flights."""
    mean = best.shared.copy()
    # What a flight has of its own, apart from the mean of the lift, is not of the vehicle
    mean[[knob.per_flight for knob in knobs]] = 0.0
    lift = find_index(knobs, NET_LIFT_FORCE)
    mean[lift] = np.mean([values[lift] for values, _ in best.flights])
    return mean


def _find_pendulum_deviations(
    nominal: NominalVehicle, knobs: Sequence[FreeParameter], best: _Estimate
) -> tuple[float, float]:
    """
    Return the standard deviations of the logarithms of the rates of roll and pitch.

    A swing tells the rate, and hardly which of inertia and centre of gravity makes it. Two fits
    differ along this ridge, so that their rates are compared and not their values.
    """

    def find_rates(values: Array) -> Array:
        rates = pendulum_rates(apply_parameters(nominal, knobs, values)[0])
        return np.log(np.maximum(rates, LEAST_RATE))

    rates, slopes = find_rates(best.shared), np.zeros((2, len(knobs)))
    for k, knob in enumerate(knobs):
        step = RATE_STEP * knob.tolerance
        moved = best.shared + step * np.eye(len(knobs))[k]
        slopes[:, k] = (find_rates(moved) - rates) / step
    variances = np.einsum('ij,jk,ik->i', slopes, best.within, slopes)
    roll, pitch = np.sqrt(variances + (find_rates(best.others) - rates) ** 2)
    return float(roll), float(pitch)


def _list_values(
    nominal: NominalVehicle,
    knobs: Sequence[FreeParameter],
    best: _Estimate,
    names: Sequence[str],
) -> list[CalibratedValue]:
    """Return all values: those of the vehicle, then those of each flight."""
    usual = ordinary_tolerances(nominal)
    own = [k for k, knob in enumerate(knobs) if knob.per_flight]
    shared = [k for k in range(len(knobs)) if k not in own]
    of_vehicle = [
        _build_value(nominal, knobs, k, best.shared, best.covariance, '', usual) for k in shared
    ]
    out = state_by_duty(of_vehicle, knobs, best.shared, best.covariance)
    for name, (values, covariance) in zip(names, best.flights, strict=True):
        out += [_build_value(nominal, knobs, k, values, covariance, name, usual) for k in own]
    return out


def _list_free_heading(
    nominal: NominalVehicle, knobs: Sequence[FreeParameter]
) -> list[CalibratedValue]:
    """Return the heading of the tracker where nothing tells it; nothing where it was fitted."""
    if any(knob.name == HEADING for knob in knobs):
        return []
    now = nominal.parameter_value(*HEADING.split('.'))
    ends = (now - math.pi, now + math.pi)
    return [CalibratedValue(HEADING, 'rad', '', now, now, ends, False, False, (MAP_DIRECTION,))]


def _build_value(
    nominal: NominalVehicle,
    knobs: Sequence[FreeParameter],
    k: int,
    values: Array,
    covariance: Array,
    flight: str,
    usual: Mapping[str, float],
) -> CalibratedValue:
    """Return one value with its interval, in the unit of the vehicle file."""
    knob, change = knobs[k], float(values[k])
    deviation = math.sqrt(max(float(covariance[k, k]), 0.0))
    ends = (change - WIDE * deviation, change + WIDE * deviation)
    is_known = deviation < LEARNED_SHARE * knob.tolerance
    before, value, (low, high) = _to_file_unit(nominal, knob, change, ends)
    is_far = is_known and abs(change) > CLEAR * math.hypot(usual.get(knob.name, 0.0), deviation)
    return CalibratedValue(
        knob.name, knob.unit, flight, before, value, (low, high), is_known, is_far,
        tuple(_list_inseparable(knobs, k, covariance)),
    )  # fmt: skip


def _to_file_unit(
    nominal: NominalVehicle, knob: FreeParameter, change: float, ends: tuple[float, float]
) -> tuple[float, float, tuple[float, float]]:
    """Return value before, value and interval from changes of a parameter."""
    (effect, parameter), rate = next(iter(knob.moves.items()))
    if effect == 'vehicle':
        # Logarithms of a factor
        return 1.0, math.exp(change), (math.exp(ends[0]), math.exp(ends[1]))
    if knob.name.endswith(('.thrust', '.reverse')):
        return 1.0, 1.0 + change, (1.0 + ends[0], 1.0 + ends[1])
    now = nominal.parameter_value(effect, parameter)
    low, high = (now + rate * end for end in ends)
    return now, now + rate * change, (low, high)


def _list_inseparable(knobs: Sequence[FreeParameter], k: int, covariance: Array) -> list[str]:
    """Return the parameters whose estimates move together with one."""
    deviation = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    alike = np.abs(covariance[k] / (deviation[k] * deviation))
    return [other.name for j, other in enumerate(knobs) if j != k and alike[j] > ALIKE_CORRELATION]
