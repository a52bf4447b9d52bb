"""
Measure what the hidden effect of a demonstration is worth in forecasts.

The truth is known here, so that no search is needed: two fits of the tolerances, without the
effect and with its true value, show whether forecasts of the held-out flight need it. A study of
the same flights takes several times as long.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, final, NamedTuple

from lta_discovery.conclusion import select_main_error
from lta_discovery.demo.hidden_effect import DemoEffect, find_present_value, VEHICLE
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, Prior, wrench_floor
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.forecast.held_out import build_model_points, compute_model_errors
from lta_discovery.forecast.tolerance_shrinkage import shrink_tolerances
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.replay.linearized_flight import LinearizationPoint, zero_unknowns
from lta_discovery.study import prepare_flight
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Times the error with the effect: below these, a demonstration shows little
LEAST_BEFORE: Final = 5.0  # error of the vehicle file
LEAST_TUNED: Final = 2.0  # error with its tolerances fitted; below it, they pass for the effect
ROUNDS: Final = 4  # most linearizations, as in the verification of a study


@final
class ForecastGain(NamedTuple):
    """Position errors of the held-out flight at the longest horizon. [m]"""

    before: float  # with the vehicle file
    tuned: float  # with its tolerances fitted
    after: float  # with the hidden effect, and the other tolerances fitted

    @property
    def is_clear(self) -> bool:
        """Whether forecasts need the effect."""
        return self.before >= LEAST_BEFORE * self.after and self.tuned >= LEAST_TUNED * self.after


def measure_forecast_gain(
    hidden: DemoEffect, bags: Mapping[Role, Sequence[Path]], seed: int
) -> ForecastGain:
    """Return how well the held-out flight is forecast without the hidden effect and with it."""
    vehicle = load_vehicle(VEHICLE)
    nominal = NominalVehicle.from_vehicle(vehicle)
    knobs = list_free_parameters(nominal)
    prepared = [
        (role, prepare_flight(vehicle, flight, knobs))
        for _, role, flight in select_usable_flights(read_bags(bags), vehicle).flights
    ]
    held_out = [flight for role, flight in prepared if role == 'holdout']
    fitter = JointFitter(
        nominal,
        [flight for role, flight in prepared if role != 'holdout'],
        per_flight_variance(knobs),
        wrench_floor(nominal),
    )
    absent = np.zeros(len(fitter.variance))
    truth = absent.copy()
    place = [knob.name for knob in knobs].index(hidden.name)
    truth[place] = hidden.value - find_present_value(knobs[place], nominal)
    bare, full = (_fit_tolerances(fitter, at) for at in (absent, truth))
    models = [build_model_points(flight, nominal, bare, full) for flight in held_out]
    error = select_main_error(compute_model_errors(held_out, models, seed, ('position',)))
    if error is None:
        return ForecastGain(0.0, 0.0, np.inf)  # a forecast diverges
    return ForecastGain(error.before, error.tuned, error.after)


def _fit_tolerances(fitter: JointFitter, at: Array) -> JointFit:
    """Return the fit of the tolerances about given values of the parameters, shape (G,)."""
    knobs = fitter.flights[0].knobs
    prior = Prior(at, build_shared_prior(knobs).covariance)
    vehicle, values = apply_parameters(fitter.nominal, knobs, at)
    points = [
        LinearizationPoint(vehicle, values, zero_unknowns(flight.replay.cut))
        for flight in fitter.flights
    ]
    begin = fitter.linearize_flights(at, points, prior)
    fit = fitter.fit(prior, begin, fitter.floor, ROUNDS, narrow=True)
    return shrink_tolerances(fitter, fit, np.flatnonzero(at))
