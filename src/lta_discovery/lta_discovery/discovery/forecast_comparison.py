"""Compare the forecasts of flights by several models of one vehicle."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_discovery.calibration.result import ForecastRms, MAIN
from lta_discovery.calibration.scores import summarize_errors
from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.state_filter.forecast_noise import adapt_noise
from lta_discovery.state_filter.forecast_sums import BLOCK
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

COASTING: Final = 'coasting'
FORECAST_DRAWS: Final = 1000  # of a bootstrap
LEAST_BLOCKS: Final = 4  # independent blocks of forecasts; fewer give no interval


@final
@dataclass(frozen=True, slots=True)
class ComparedModel:
    """A model of a vehicle that forecasts flights."""

    name: str
    nominal: NominalVehicle
    noise: Sequence[NoiseModel]  # learned beside this model, of the flights it was fitted to


@final
class HorizonErrors(NamedTuple):
    """RMS errors at one horizon, by the name of the model; that of coasting is among them."""

    horizon: float  # [s]
    errors: Mapping[str, ForecastRms]
    forecasts: int  # number


@final
class ErrorRatio(NamedTuple):
    """Position error of one model by that of another, with a 95 % interval."""

    value: float
    ci95: tuple[float, float]  # NaN with too few forecasts


@final
@dataclass(frozen=True, slots=True)
class ForecastComparison:
    """Forecasts of the same flights by several models."""

    names: tuple[str, ...]  # of the flights
    flights: tuple[MeasuredFlight, ...]
    # Of each flight, by the name of the model; empty if no flight is long enough
    forecasts: Mapping[str, Sequence[FlightForecasts]]

    @property
    def scores(self) -> list[HorizonErrors]:
        """Errors at each horizon that is reached."""
        first = next(iter(self.forecasts.values()), ())
        out = []
        for h, horizon in enumerate(first[0].horizons if first else ()):
            tables = {name: self._stack(each, h) for name, each in self.forecasts.items()}
            tables[COASTING] = np.concatenate([one.coasting[:, h] for one in first])
            headings = np.concatenate([one.headings for one in first])
            measured = ~np.isnan(np.stack(list(tables.values()))).any(axis=(0, 2))
            if measured.any():
                rms = {
                    name: summarize_errors(table[measured], headings[measured])
                    for name, table in tables.items()
                }
                out.append(HorizonErrors(horizon, rms, int(measured.sum())))
        return out

    @property
    def main(self) -> HorizonErrors | None:
        """The errors that headlines state: 3 s ahead, or the furthest below it."""
        near = [one for one in self.scores if one.horizon <= MAIN]
        return max(near, key=lambda one: one.horizon, default=None)

    @staticmethod
    def _stack(each: Sequence[FlightForecasts], h: int) -> Array:
        return np.concatenate([one.errors[:, h] for one in each])

    def compare(self, model: str, other: str, seed: int = 0) -> ErrorRatio:
        """
        Return the position error of a model by that of another one, at the main horizon.

        The interval is that of a bootstrap over blocks of 10 s, whose errors are independent.
        """
        main = self.main
        if main is None:
            return ErrorRatio(math.nan, (math.nan, math.nan))
        h = self.forecasts[model][0].horizons.index(main.horizon)
        pairs, blocks = [], []
        for f, (one, two) in enumerate(
            zip(self.forecasts[model], self.forecasts[other], strict=True)
        ):
            squares = [np.sum(each.errors[:, h, :3] ** 2, axis=1) for each in (one, two)]
            pairs.append(np.column_stack(squares))
            blocks += [(f, int(start // BLOCK)) for start in one.starts]
        table = np.concatenate(pairs)
        measured = ~np.isnan(table).any(axis=1)
        labels = np.unique(np.array(blocks)[measured], axis=0, return_inverse=True)[1]
        sums = np.zeros((labels.max(initial=-1) + 1, 2))
        np.add.at(sums, labels.ravel(), table[measured])
        return _bootstrap_ratio(sums, seed)


def _bootstrap_ratio(sums: Array, seed: int) -> ErrorRatio:
    """Return the ratio of two RMS errors from the squares summed in each block, shape (B, 2)."""
    with np.errstate(invalid='ignore', divide='ignore'):
        whole = float(np.sqrt(np.divide(*sums.sum(axis=0))))
        if len(sums) < LEAST_BLOCKS:
            return ErrorRatio(whole, (math.nan, math.nan))
        draws = np.random.default_rng(seed).integers(len(sums), size=(FORECAST_DRAWS, len(sums)))
        totals = sums[draws].sum(axis=1)
        low, high = np.percentile(np.sqrt(totals[:, 0] / totals[:, 1]), [2.5, 97.5])
    return ErrorRatio(whole, (float(low), float(high)))


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
    return ForecastComparison(tuple(flights), tuple(measured), forecasts)
