# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Calibrate a vehicle as the first step of a discovery, where its flights call for it.

A short linear fit of forecasts over a second tells in a second of computing time whether a gain,
the net lift of the flights or the markers' frame may be far from the vehicle file, and forecasts
over three seconds whether the file predicts hardly better than coasting. Only then is the vehicle
calibrated, and only a clear difference that discovery has no name for is a reason to
go on from the calibrated file. Flights of a good file can still differ in their net lift: then
the file stays, and each flight has a lift of its own.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final

from lta_discovery.calibration.calibration import calibrate_flights
from lta_discovery.calibration.corrections import (
    compare_with_file,
    forecast_role,
    is_contradicted,
    relative_error,
    relative_position_error,
)
from lta_discovery.calibration.prepared_flights import fit_quickly, prepare_calibration
from lta_discovery.calibration.result import CalibratedValue, Calibration, WIDE
from lta_discovery.flights.bags import assign_roles, AssignedFlight
from lta_discovery.model.calibration_parameters import (
    BY_EYE,
    GAIN_NAMES,
    HEADING,
    list_marker_parameters,
    ordinary_tolerances,
    PER_FLIGHT,
    prior_deviation,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, GAIN_SPREAD, NET_LIFT_FORCE
from lta_discovery.settings import CALLS, CLEAR, ERROR_RATIOS, LIFT_GAP, MAYBE, MUCH, POOR, USELESS
from lta_discovery.state_filter.forecast_scores import (
    CALIBRATED,
    COASTING,
    FILE_MODEL,
    find_main_score,
    HorizonErrors,
)
from lta_discovery.state_filter.noise_model import average_noise
from lta_model.vehicle import Vehicle
import numpy as np

Progress = Callable[[str, float | None], None]


@final
@dataclass(frozen=True, slots=True)
class FirstStep:
    """What the check of the calibration found."""

    calibration: Calibration | None = None  # to go on from; None if the file is good enough
    # One that is no reason to go on from, but may forecast better than what is found
    alternative: Calibration | None = None
    # The lowest and the highest net lift, if the flights differ in it and the file is kept
    lifts: tuple[CalibratedValue, ...] = ()

    @property
    def compared(self) -> Calibration | None:
        """Return the calibration whose forecasts are compared with the others."""
        return self.calibration or self.alternative


def calibrate_first(
    vehicle: Vehicle, name: str, flights: Sequence[AssignedFlight], tell: Progress
) -> FirstStep:
    """
    Calibrate a vehicle if its flights call for it.

    Raises
    ------
    BadInput
        If there is no training flight.

    """
    # A held-out flight or part must not take part in any fit
    fit_flights = [one for one in assign_roles(flights)[0] if one[1] != 'holdout']
    tell('checking the calibration', 0.0)
    suspicions = _list_suspicions(vehicle, fit_flights)
    if not suspicions:
        return FirstStep()
    calibration = calibrate_flights(vehicle, name, fit_flights, tell)
    if _is_clearly_better(calibration, reasons := list(_list_reasons(calibration))):
        return FirstStep(_mark_reasons(calibration, reasons))
    usable = calibration.method != 'file' and not is_contradicted(calibration.scores)
    alternative = calibration if usable else None
    if NET_LIFT_FORCE not in suspicions:
        return FirstStep(alternative=alternative)
    lifts = list(_list_different_lifts(calibration))
    if not lifts:
        # Training flights of one lift do not show that the confirming ones have another
        both = [(title, 'train', flight) for title, _, flight in fit_flights]
        calibration = calibrate_flights(vehicle, name, both, tell)
        lifts = list(_list_different_lifts(calibration))
        alone = [role for _, role, _ in fit_flights].count('train') == 1
        if alone and _is_clearly_better(calibration, lifts):
            return FirstStep(_mark_reasons(calibration, lifts))
    # By whatever the values are fitted, the readings of each flight tell its lift
    if calibration.method == 'file':
        lifts = []
    return FirstStep(alternative=alternative, lifts=tuple(lifts))


def _is_clearly_better(calibration: Calibration, reasons: Sequence[CalibratedValue]) -> bool:
    """Return whether a calibration has a reason, and its forecasts are better than the file's."""
    if not reasons or is_contradicted(calibration.scores):
        return False
    scores = [*calibration.scores.get('train', ()), *calibration.scores.get('confirm', ())]
    error, place = relative_error(scores), relative_position_error(scores)
    # From a file that predicts poorly, no effect can be named
    if _beats_coasting(calibration):
        if _predicts_poorly(calibration.scores, USELESS) and error <= ERROR_RATIOS['likelihood']:
            return True
        if _predicts_poorly(calibration.scores, POOR) and place <= MUCH:
            return True
    if calibration.method == 'likelihood':
        # The lift of a flight shows in its positions alone
        error = min(error, place)
    # An error that is not a number is not better
    return error <= ERROR_RATIOS[calibration.method]


def _list_main_positions(
    scores: Mapping[str, Sequence[HorizonErrors]],
) -> list[dict[str, float]]:
    """Return the position errors by model in each role that has forecasts."""
    return [main.positions for each in scores.values() if (main := find_main_score(each))]


def _predicts_poorly(scores: Mapping[str, Sequence[HorizonErrors]], share: float) -> bool:
    """Return whether the file's errors exceed a share of those of coasting, in all roles."""
    sizes = _list_main_positions(scores)
    return bool(sizes) and all(one[FILE_MODEL] > share * one[COASTING] for one in sizes)


def _beats_coasting(calibration: Calibration) -> bool:
    """Return whether a calibration predicts the positions of all roles better than coasting."""
    sizes = _list_main_positions(calibration.scores)
    return calibration.method != 'file' and all(one[CALIBRATED] < one[COASTING] for one in sizes)


def _mark_reasons(calibration: Calibration, reasons: Sequence[CalibratedValue]) -> Calibration:
    """Let the first line and the table name the reasons, also those within three tolerances."""
    values = [replace(one, is_far=one.is_far or one in reasons) for one in calibration.values]
    return replace(calibration, values=tuple(values))


def _list_suspicions(vehicle: Vehicle, flights: Sequence[AssignedFlight]) -> list[str]:
    """
    Return the parameters that a short fit finds far from the file, or between flights.

    'forecasts' stands for a file that predicts the flights poorly.
    """
    both = [(title, 'train', flight) for title, _, flight in flights]
    prepared = prepare_calibration(vehicle, both)
    fit = fit_quickly(prepared)
    names = [one.name for one in prepared.parameters]
    own = names.index(NET_LIFT_FORCE)
    lifts = [float(values[own]) for values, _ in fit.own]
    deviations = np.sqrt(np.diag(fit.covariance))
    off = [
        name
        for name, value, deviation in zip(names, fit.values, deviations, strict=True)
        if _is_off(name, float(value), float(deviation))
    ]
    if max(lifts) - min(lifts) > MAYBE * LIFT_GAP:
        return [NET_LIFT_FORCE, *off]
    if off:
        return off
    # A pendulum of another period does not show in few steps
    noise = average_noise(fit.noise)
    alone = forecast_role(prepared, 'train', prepared.nominal, noise)
    scores = compare_with_file(alone, alone)
    return ['forecasts'] if _predicts_poorly({'all': scores}, POOR) else []


def _is_off(name: str, value: float, deviation: float) -> bool:
    """Return whether a parameter of a quick fit may be off."""
    least = find_calling_difference(name)
    return least is not None and abs(value) > max(MAYBE * least, CLEAR * deviation)


def find_calling_difference(name: str) -> float | None:
    """Return the difference of a parameter that calls for a calibration; None if none does."""
    if name.startswith('rotor_') and not name.endswith('.thrust'):
        return None
    return next((size for start, size in CALLS.items() if name.startswith(start)), None)


def _list_reasons(calibration: Calibration) -> Iterator[CalibratedValue]:
    """Yield the values that are a reason to go on from the calibrated file."""
    for one in calibration.values:
        least = None if one.flight else find_calling_difference(one.name)
        if least is not None and is_difference_clear(one, least):
            yield one
    yield from _list_different_lifts(calibration)


def _list_different_lifts(calibration: Calibration) -> Iterator[CalibratedValue]:
    """Yield the lowest and the highest net lift of the flights if they differ clearly."""
    lifts = calibration.list_of_flights(NET_LIFT_FORCE)
    if lifts:
        low, high = (each(lifts, key=lambda one: one.value) for each in (min, max))
        if high.value - low.value > max(LIFT_GAP, CLEAR * (low.deviation + high.deviation)):
            yield from (low, high)


def is_difference_clear(one: CalibratedValue, least: float) -> bool:
    """Return whether a value is off by more than a size and by more than its interval explains."""
    return one.is_known and abs(one.value - one.before) > max(least, CLEAR * one.deviation)


NO_THRUST: Final = 0.05  # relative; a rotor with less has an uncertain thrust


def apply_calibration(
    knobs: Sequence[FreeParameter], nominal: NominalVehicle, values: Sequence[CalibratedValue]
) -> list[FreeParameter]:
    """
    Return the free parameters of a discovery after a calibration, those of the markers included.

    A calibrated number is as well known as in a vehicle that was measured with care, or as its
    interval says if that is wider. It is no candidate: what calibration explains is no effect.

    `nominal`: the calibrated vehicle.
    """
    usual = ordinary_tolerances(nominal)
    by_name = {one.name: one for one in values}
    out = []
    for knob in [*knobs, *list_marker_parameters()]:
        one = by_name.get(knob.name)
        is_fitted = knob.name == HEADING and one is not None and one.is_known
        if one is None or not (knob.is_calibration or knob.name in PER_FLIGHT or is_fitted):
            out.append(knob)
            continue
        own = knob.name in PER_FLIGHT
        tolerance = max(usual.get(knob.name, 0.0), _posterior_deviation(one))
        if own:
            tolerance = _flight_deviation(knob, nominal, values)
        elif knob.name in GAIN_NAMES:
            tolerance = max(GAIN_SPREAD * abs(one.value), one.deviation)
        low = -math.inf if own else knob.low
        out.append(
            replace(
                knob,
                tolerance=tolerance,
                typical=0.0,
                low=low,
                per_flight=knob.per_flight or own,
            )
        )
    return out


def free_flight_lifts(
    knobs: Sequence[FreeParameter], nominal: NominalVehicle
) -> list[FreeParameter]:
    """Return the free parameters with a net lift that each flight may have of its own."""
    return [
        replace(knob, tolerance=prior_deviation(knob, nominal), typical=0.0, low=-math.inf)
        if knob.name == NET_LIFT_FORCE
        else knob
        for knob in knobs
    ]


def _flight_deviation(
    knob: FreeParameter, nominal: NominalVehicle, values: Sequence[CalibratedValue]
) -> float:
    """Return the standard deviation of what each flight has of its own."""
    if knob.name == NET_LIFT_FORCE:
        # That of other flights does not tell it
        return prior_deviation(knob, nominal)
    trends = [one.value for one in values if one.name == knob.name]
    return max(BY_EYE[knob.name], math.sqrt(sum(each**2 for each in trends) / len(trends)))


def _posterior_deviation(one: CalibratedValue) -> float:
    """Return the standard deviation of a calibrated number, in the unit of its parameter."""
    if one.name.startswith('vehicle.'):
        return math.log(one.ci95[1] / one.ci95[0]) / (2.0 * WIDE)
    if one.name.endswith('.thrust'):
        # Relative to the calibrated thrust
        return one.deviation / max(abs(one.value), NO_THRUST)
    return one.deviation
