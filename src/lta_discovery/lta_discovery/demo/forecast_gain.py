# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Measure what the hidden effect of a demonstration is worth in forecasts.

The truth is known here, so that no search is needed: two fits of the tolerances, without the
effect and with its true value, show whether forecasts of the held-out flight need it.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, final, NamedTuple

from lta_discovery.demo.hidden_effect import (
    DemoEffect,
    find_free_parameter,
    find_present_value,
    HIDDEN_VEHICLE,
)
from lta_discovery.discovery.forecast_comparison import compare_forecasts, ComparedModel
from lta_discovery.discovery.study import NAMED, TUNED
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import apply_parameters, list_free_parameters
from lta_discovery.posterior.missing_elements import LEARNING, LINEARIZATIONS
from lta_discovery.state_filter.forecast_scores import FILE_MODEL
from lta_discovery.state_filter.forecast_sums import HORIZONS
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.parameter_fit import fit_likelihood
from lta_model.vehicle import load_vehicle, Vehicle
import numpy as np

# Times the error with the effect: below these, a demonstration shows little
LEAST_BEFORE: Final = 5.0  # error of the vehicle file
LEAST_TUNED: Final = 2.0  # error with its tolerances fitted; below it, they pass for the effect


@final
class ForecastGain(NamedTuple):
    """Position errors of the held-out flight, 3 s ahead [m]."""

    before: float  # with the vehicle file
    tuned: float  # with its tolerances fitted
    after: float  # with the hidden effect, and the tolerances fitted

    @property
    def is_clear(self) -> bool:
        """Whether forecasts need the effect."""
        return self.before >= LEAST_BEFORE * self.after and self.tuned >= LEAST_TUNED * self.after


def measure_forecast_gain(hidden: DemoEffect, bags: Mapping[Role, Sequence[Path]]) -> ForecastGain:
    """Return how well the held-out flight is forecast without the hidden effect and with it."""
    vehicle = load_vehicle(HIDDEN_VEHICLE)
    nominal = NominalVehicle.from_vehicle(vehicle)
    parameter = find_free_parameter(hidden.name)
    changed = parameter.apply_to(nominal, hidden.value - find_present_value(parameter, nominal))
    flights = select_usable_flights(read_bags(bags), vehicle).flights
    used = [flight for _, role, flight in flights if role != 'holdout']
    guess = [NoiseModel.guess(nominal, one) for one in used]
    models = [
        ComparedModel(FILE_MODEL, nominal, guess),
        _fit_tolerances(TUNED, vehicle, nominal, used, guess),
        _fit_tolerances(NAMED, vehicle, changed, used, guess),
    ]
    held_out = {name: flight for name, role, flight in flights if role == 'holdout'}
    main = compare_forecasts(
        vehicle, used, held_out, models, list_free_parameters(nominal), HORIZONS
    ).main
    if main is None:
        return ForecastGain(0.0, 0.0, np.inf)
    return ForecastGain(*(main.errors[name].position for name in (FILE_MODEL, TUNED, NAMED)))


def _fit_tolerances(
    name: str,
    vehicle: Vehicle,
    nominal: NominalVehicle,
    flights: Sequence[MeasuredFlight],
    noise: Sequence[NoiseModel],
) -> ComparedModel:
    """Return a vehicle with its tolerances fitted to some flights."""
    parameters = [one for one in list_free_parameters(nominal) if one.tolerance > 0.0]
    systems = [FlightSystem(vehicle, one, parameters) for one in flights]
    fit = fit_likelihood(
        systems, nominal, np.zeros(len(parameters)), noise, LINEARIZATIONS, LEARNING, is_near=True
    )
    shared = np.where([one.per_flight for one in parameters], 0.0, fit.values)
    return ComparedModel(name, apply_parameters(nominal, parameters, shared)[0], fit.noise)
