"""Calibrate a vehicle file from flights: values with intervals, and what cannot be separated."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final

from lta_discovery.calibration.coarse_fit import CoarseCalibration
from lta_discovery.calibration.forecast_score import relative_error, score_axes, score_forecasts
from lta_discovery.calibration.prepared_flights import find_index, fit_coarsely, fit_further
from lta_discovery.calibration.refined_fit import refine_calibration
from lta_discovery.calibration.result import CalibratedValue, Calibration, ForecastScore, WIDE
from lta_discovery.calibration.reversed_thrust import state_by_duty
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.flights.role_assignment import Role
from lta_discovery.model.calibration_parameters import (
    HEADING,
    ordinary_tolerances,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, NET_LIFT
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Progress = Callable[[str, float | None], None]

KNOWN: Final = 0.7  # of the deviation before; a value with a larger one was not learned
ALIKE: Final = 0.85  # correlation; values above it cannot be separated
FAR: Final = 3.0  # tolerances; a value further from the file is reported first
# Of the refined fit's forecast error; the coarse fit needs less. It is fitted to these forecasts,
# and follows the noise in their initial states, too.
BETTER: Final = 0.85
# Noise of the readings in a fit whose forecasts are poor, by that of the tracker: of real flights,
# whose forces no model has, such a fit forecasts nearly as well as one to the forecasts
NOISIER: Final = 20.0
MAP: Final = 'the direction of the axes of the map'


@final
@dataclass(frozen=True, slots=True)
class _Estimate:
    """Values with covariance: shared, and of each flight (all parameters of it)."""

    method: str
    shared: Array
    covariance: Array
    flights: Sequence[tuple[Array, Array]]


def calibrate_flights(
    vehicle: Vehicle,
    name: str,
    flights: Sequence[Role],
    tell: Progress,
    with_flows: bool = True,
) -> Calibration:
    """
    Calibrate a vehicle with its training flights, and score the result on all.

    `with_flows`: whether the calibrated vehicle has the fitted drag and added mass, too, which a
    discovery names as effects.
    """
    prepared, coarse = fit_coarsely(vehicle, flights, tell)
    nominal, knobs, roles = prepared.nominal, prepared.knobs, prepared.flights
    tell('fitting readings', 0.5)
    estimates = _list_estimates(nominal, roles['train'], coarse, knobs)
    tell('forecasting', 0.8)
    best, scores = _choose_estimate(nominal, roles['train'], estimates, knobs)
    if best.method == 'forecasts':
        # Something of the flights is in no model
        prepared, coarse = fit_further(vehicle, flights, prepared, coarse)
        knobs, roles = prepared.knobs, prepared.flights
        estimates = [_build_estimate('forecasts', coarse, knobs), estimates[-1]]
        best, scores = _choose_estimate(nominal, roles['train'], estimates, knobs)
    told_scores = {'train': scores}
    own = _list_flight_values(best, knobs)
    axes = {'train': score_axes(nominal, roles['train'], best.shared, own)}
    if roles['confirm']:
        shared = _without_lift(best.shared, knobs)
        # As in the calibrated file; what a flight differs by, its own earlier forecasts tell
        shared[find_index(knobs, NET_LIFT)] = _mean_lift(best, knobs)
        told_scores['confirm'] = score_forecasts(nominal, roles['confirm'], shared, None)
        axes['confirm'] = score_axes(nominal, roles['confirm'], shared, None)
    if best.method == 'forecasts':
        tell('fitting intervals', 0.9)
        best = _widen_intervals(nominal, roles['train'], coarse, best)
    tell('done', 1.0)
    return Calibration(
        name,
        nominal,
        _build_calibrated_vehicle(nominal, knobs, best, with_flows),
        (
            *_list_values(nominal, knobs, best, prepared.names['train']),
            *_list_free_heading(nominal, knobs),
        ),
        told_scores,
        best.method,
        {role: tuple(each) for role, each in prepared.names.items()},
        axis_scores=axes,
    )


def _build_calibrated_vehicle(
    nominal: NominalVehicle, knobs: Sequence[FreeParameter], best: _Estimate, with_flows: bool
) -> NominalVehicle:
    """Return the vehicle with the calibrated values and the mean net lift of the flights."""
    mean = best.shared[: len(knobs)].copy()
    lift = find_index(knobs, NET_LIFT)
    mean[lift] = _mean_lift(best, knobs)
    for k, knob in enumerate(knobs):
        # What a flight has of its own, apart from the mean of the lift, is not of the vehicle
        if (knob.per_flight and k != lift) or not (with_flows or knob.is_calibration):
            mean[k] = 0.0
    return apply_parameters(nominal, knobs, mean)[0]


def _mean_lift(best: _Estimate, knobs: Sequence[FreeParameter]) -> float:
    """Return the mean net lift of the flights. [N]"""
    lift = find_index(knobs, NET_LIFT)
    return float(np.mean([values[lift] for values, _ in best.flights]))


def _without_lift(values: Array, knobs: Sequence[FreeParameter]) -> Array:
    """Return shared values without what each flight has of its own."""
    own = np.array([knob.per_flight for knob in knobs])
    return np.where(own, 0.0, values[: len(knobs)])


def _list_flight_values(one: _Estimate, knobs: Sequence[FreeParameter]) -> list[Array]:
    """Return the shared values with what each flight has of its own: its lift and its trend."""
    is_own = np.array([knob.per_flight for knob in knobs])
    return [np.where(is_own, values, one.shared) for values, _ in one.flights]


def _list_estimates(
    nominal: NominalVehicle,
    flights: Sequence[FlightLinearizer],
    coarse: CoarseCalibration,
    knobs: Sequence[FreeParameter],
) -> list[_Estimate]:
    """Return the estimates in the order of preference; that of the file is the last."""
    out, count = [], len(knobs)
    fit = refine_calibration(nominal, flights, coarse)
    if fit is not None and np.isfinite(fit.fitted.covariance).all():
        members = [
            (one.fitted.mean[:count], one.fitted.covariance[:count, :count]) for one in fit.members
        ]
        shared, covariance = fit.fitted.mean[:count], fit.fitted.covariance[:count, :count]
        out.append(_Estimate('likelihood', shared, covariance, members))
    file = replace(coarse, values=np.zeros(count), lifts=np.zeros(len(flights)))
    out.append(_build_estimate('forecasts', coarse, knobs))
    out.append(_build_estimate('file', file, knobs))
    return out


def _build_estimate(
    method: str, coarse: CoarseCalibration, knobs: Sequence[FreeParameter]
) -> _Estimate:
    """Return the estimate of a coarse calibration."""
    members, lift = [], find_index(knobs, NET_LIFT)
    for force in coarse.lifts:
        own = coarse.values.copy()
        own[lift] += force
        members.append((own, coarse.covariance))
    return _Estimate(method, coarse.values, coarse.covariance, members)


def _choose_estimate(
    nominal: NominalVehicle,
    flights: Sequence[FlightLinearizer],
    estimates: Sequence[_Estimate],
    knobs: Sequence[FreeParameter],
) -> tuple[_Estimate, tuple[ForecastScore, ...]]:
    """
    Return the estimate that forecasts the training flights best, and its scores.

    None is returned that forecasts them worse than the vehicle file.
    """
    best, error = estimates[-1], math.inf
    best_scores: tuple[ForecastScore, ...] = ()
    for one in estimates:
        own = _list_flight_values(one, knobs)
        scores = score_forecasts(nominal, flights, one.shared, own)
        now = relative_error(scores)
        if now < (error if math.isinf(error) else BETTER * error) and now < 1.0:
            best, best_scores, error = one, scores, now
        elif one.method == 'file' and math.isinf(error):
            best, best_scores = one, scores
    return best, best_scores


def _widen_intervals(
    nominal: NominalVehicle,
    flights: Sequence[FlightLinearizer],
    coarse: CoarseCalibration,
    best: _Estimate,
) -> _Estimate:
    """
    Return the estimate from forecasts with the intervals of a fit to all readings.

    Errors of a model make the two differ by more than either interval says, so that the square of
    the difference is added to the variance. Parameters that were left out are free in that
    fit, so that the others are not too certain, but keep the intervals assumed before.
    """
    fit = refine_calibration(nominal, flights, coarse, NOISIER)
    if fit is None or not np.isfinite(fit.fitted.covariance).all():
        return best
    both = [(best.shared, fit.fitted)]
    both += [(own, one.fitted) for (own, _), one in zip(best.flights, fit.members, strict=True)]
    (shared, covariance), *members = (
        (
            values,
            _keep_assumed(
                _add_difference(values, other.mean, other.covariance),
                flights[0].knobs,
                coarse.held,
            ),
        )
        for values, other in both
    )
    return _Estimate('both', shared, covariance, members)


def _add_difference(values: Array, mean: Array, covariance: Array) -> Array:
    """Return the covariance of a mean with the squared differences from some values."""
    count = len(values)
    wide: Array = covariance[:count, :count] + np.diag((values - mean[:count]) ** 2)
    return wide


def _keep_assumed(covariance: Array, knobs: Sequence[FreeParameter], held: Sequence[int]) -> Array:
    """Return a covariance in which some parameters have the deviations assumed before."""
    out, picked = covariance.copy(), list(held)
    out[picked] = 0.0
    out[:, picked] = 0.0
    out[picked, picked] = [knobs[k].tolerance ** 2 for k in picked]
    return out


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
    return [CalibratedValue(HEADING, 'rad', '', now, now, ends, False, False, (MAP,))]


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
    is_known = deviation < KNOWN * knob.tolerance
    before, value, (low, high) = _to_file_unit(nominal, knob, change, ends)
    is_far = is_known and abs(change) > FAR * math.hypot(usual.get(knob.name, 0.0), deviation)
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
    return [other.name for j, other in enumerate(knobs) if j != k and alike[j] > ALIKE]
