# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare the forecasts of flights by several models of one vehicle."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import final, Self

from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.state_filter.forecast_noise import adapt_noise
from lta_discovery.state_filter.forecast_scores import (
    compare_errors,
    ErrorRatio,
    find_main_score,
    HorizonErrors,
    score_forecasts,
)
from lta_discovery.state_filter.forecasts import (
    FlightForecasts,
    forecast_flights,
    list_flight_parameters,
)
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import average_noise, NoiseModel
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class ComparedModel:
    """A model of a vehicle that forecasts flights."""

    name: str
    nominal: NominalVehicle
    noise: Sequence[NoiseModel]  # learned beside this model, of the flights it was fitted to


@final
@dataclass(frozen=True, slots=True)
class ForecastComparison:
    """Forecasts of the same flights by several models."""

    names: tuple[str, ...]  # of the flights
    # Of each flight, by the name of the model; empty if no flight is long enough
    forecasts: Mapping[str, Sequence[FlightForecasts]]

    @property
    def scores(self) -> tuple[HorizonErrors, ...]:
        """Errors at each horizon that is reached."""
        return score_forecasts(self.forecasts)

    @property
    def main(self) -> HorizonErrors | None:
        """Return the errors that headlines state."""
        return find_main_score(self.scores)

    def compare(self, model: str, other: str) -> ErrorRatio:
        """Return the position error of a model by that of another one."""
        return compare_errors(self.forecasts[model], self.forecasts[other])

    def is_better(self, model: str, other: str) -> bool:
        """Return whether a model forecasts positions better than another one, with 95 %."""
        return bool(self.scores) and self.compare(model, other).ci95[1] < 1.0

    def without(self, *models: str) -> Self:
        """Return the comparison without some models."""
        return replace(
            self, forecasts={key: one for key, one in self.forecasts.items() if key not in models}
        )


def compare_forecasts(
    vehicle: Vehicle,
    training: Sequence[MeasuredFlight],
    flights: Mapping[str, MeasuredFlight],
    models: Sequence[ComparedModel],
    parameters: Sequence[FreeParameter],
    horizons: Sequence[float],
) -> ForecastComparison:
    """
    Forecast flights with each model.

    `training`: flights to which the noise of the forecasts is fitted. `flights`: those that are
    forecast, by name. `parameters`: of which a flight has some of its own. `horizons`: how far
    ahead, rising [s].
    """
    measured = list(flights.values())
    systems = [FlightSystem(vehicle, one, parameters) for one in training]
    forecasts = {}
    for model in models if horizons else ():
        own = list_flight_parameters(model.nominal, parameters)
        usual = adapt_noise(systems, model.nominal, average_noise(model.noise), horizons)
        noise = [NoiseModel.guess(model.nominal, one).learn_from(usual) for one in measured]
        forecasts[model.name] = forecast_flights(
            vehicle, model.nominal, measured, own, noise, horizons
        )
    return ForecastComparison(tuple(flights), forecasts)
