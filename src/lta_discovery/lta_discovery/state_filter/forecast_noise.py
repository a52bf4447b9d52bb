# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Choose how large unexplained forces are and how long they last, so that forecasts are best.

The errors of forecasts are sums that are linear in the parameters, each with its weight.
"""

from collections.abc import Sequence
from dataclasses import replace
import functools
import math
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.flights.noise import NOISE_MEDIAN
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.parallel import map_parallel
from lta_discovery.state_filter.kalman import filter_flight, FilteredFlight
from lta_discovery.state_filter.likelihood import linearize_all, ParameterPrior
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight
from lta_discovery.state_filter.noise_model import average_noise, NoiseModel
import numpy as np
from numpy.typing import NDArray

FACTOR: Final = 2.0  # between two sizes or memories that are tried; errors change by some per cent
MOST_NOISE_FACTORS: Final = 4  # such factors in either direction
CLEARLY: Final = 0.003  # of the mean logarithm of the errors; less is no reason for another noise


def fit_forecast_noise(
    flights: Sequence[LinearFlight],
    noise: Sequence[NoiseModel],
    prior: ParameterPrior,
    horizons: Sequence[float],
) -> list[NoiseModel]:
    """
    Return the noise under which the forecasts of some flights are best.

    Under the most probable noise, whatever a model lacks is a force that acts on for as long as
    one reading is like the next. Over seconds of a forecast, much of it fades or follows the
    commands. The sensors keep their noise; the forces and moments of all axes change alike.
    """
    # The errors at the values need no slopes by what the flights share
    flights, prior = [one.keep_columns(prior.own) for one in flights], prior.of_flight

    def build(size: int, memory: int) -> list[NoiseModel]:
        return [
            replace(one, wrench_ahead=FACTOR**size, memory_ahead=FACTOR**memory) for one in noise
        ]

    @functools.cache
    def measure(size: int, memory: int) -> float:
        try:
            return measure_errors(flights, build(size, memory), prior, horizons)
        except np.linalg.LinAlgError:
            # So unstable that a filter loses it
            return math.inf

    best = (0, 0)
    while True:
        size, memory = best
        near = [(size - 1, memory), (size, memory - 1), (size + 1, memory), (size, memory + 1)]
        inside = [one for one in near if max(map(abs, one)) <= MOST_NOISE_FACTORS]
        after = min(inside, key=lambda one: measure(*one))
        if not measure(*after) < measure(*best) - CLEARLY:
            return build(*best)
        best = after


def adapt_noise(
    systems: Sequence[FlightSystem],
    nominal: NominalVehicle,
    noise: NoiseModel,
    horizons: Sequence[float],
) -> NoiseModel:
    """
    Return the noise under which a model forecasts some flights best (`fit_forecast_noise`).

    `nominal`: the model; one that diverges keeps its noise. `noise`: the most probable one.
    """
    parameters = systems[0].parameters
    prior = ParameterPrior.of(parameters)
    try:
        flights = linearize_all(systems, nominal, np.zeros(len(parameters)), prior.own)
    except BadInput:
        return noise
    usual = [NoiseModel.guess(nominal, one.flight).learn_from(noise) for one in systems]
    return average_noise(fit_forecast_noise(flights, usual, prior, horizons))


Array = NDArray[np.float64]

HORIZONS: Final = (1.0, 3.0, 8.0)  # s; of the forecasts
SHORT: Final = (0.4, 0.8, 1.2)  # s; those of flights too short for them
FIT_FORECAST_INTERVAL: Final = 0.75  # s; between the starts of the forecasts of a fit
FIRST_START: Final = 1.0  # s; from the beginning of a run, in which the filter settles
ERROR_PARTS: Final = (slice(0, 3), slice(3, 6))  # position and attitude of an error
ATTITUDE: Final = 0.5  # weight of an error of attitude by that of position, each in its usual size
ERROR_WEIGHTS: Final = np.array([1.0] * 3 + [ATTITUDE] * 3)
ROBUST: Final = 4.5  # usual sizes; larger errors have a linear cost instead of a quadratic one
# s; errors further apart than this are independent. Of the wind in a draught, whose memory is 5 s,
# blocks of 2, 5, 10 or 20 s scatter 1.6, 2.1, 2.4 or 2.5 times as far as noise
BLOCK: Final = 10.0
WEIGHINGS: Final = 5  # times that a step weighs linear errors; more gain little


@final
class ForecastSum(NamedTuple):
    """Errors of forecasts about some parameters."""

    inner: Array  # precision of the parameters, shape (K, K)
    pull: Array  # shape (K,)
    cost: float  # mean logarithm of the usual errors, attitude with its weight
    blocks: Array  # pull of each block of independent errors, shape (B, K)
    errors: Array  # of the forecasts, shape (S, H, 6, K + 1) [m, rad]

    def step(self, prior: ParameterPrior, values: Array, damping: float, longest: float) -> Array:
        """Return the best values as far as the errors are linear; see `ParameterPrior.step`."""
        after = prior.step(values, self.inner, self.pull, damping, longest)
        if damping > 0.0:
            return after
        near = prior.limit(values, longest)
        for _ in range(WEIGHINGS - 1):
            errors = self.errors.copy()
            errors[..., -1] += self.errors[..., :-1] @ (after - values)
            inner, pulls = _sum_errors(weigh_errors(errors)[0], prior)
            pull = pulls.sum(axis=0) - after * prior.precision
            after = near.step(after, inner, pull)
        return after


def sum_forecasts(
    flights: Sequence[LinearFlight],
    noise: Sequence[NoiseModel],
    prior: ParameterPrior,
    values: Array,
    horizons: Sequence[float],
) -> ForecastSum:
    """Return the errors of all forecasts about some values."""
    errors = np.concatenate(list_errors(flights, noise, prior, horizons))
    places = [
        (f, int(start * GRID_PERIOD / BLOCK))
        for f, flight in enumerate(flights)
        for start in list_starts(flight.runs, FIT_FORECAST_INTERVAL)
    ]
    weighed, size = weigh_errors(errors)
    inner, pulls = _sum_errors(weighed, prior)
    block = np.unique(places, axis=0, return_inverse=True)[1].ravel()
    blocks = np.zeros((block.max() + 1, len(values)))
    np.add.at(blocks, block, pulls)
    # What the steps make smaller: a weight of an error is one of its square
    cost = float(np.average(np.log(size).mean(axis=0), weights=ERROR_WEIGHTS**2))
    return ForecastSum(inner, pulls.sum(axis=0) - values * prior.precision, cost, blocks, errors)


def _sum_errors(weighed: Array, prior: ParameterPrior) -> tuple[Array, Array]:
    """Return the precision of the parameters, and the pull of each forecast, shape (S, K)."""
    table = weighed.reshape(len(weighed), -1, weighed.shape[-1])
    pulls = -np.einsum('spk,sp->sk', table[..., :-1], table[..., -1])
    flat = table[..., :-1].reshape(-1, pulls.shape[1])
    return np.diag(prior.precision) + flat.T @ flat, pulls


def list_errors(
    flights: Sequence[LinearFlight],
    noise: Sequence[NoiseModel],
    prior: ParameterPrior,
    horizons: Sequence[float],
) -> list[Array]:
    """Return the errors of the forecasts of each flight, shape (S, H, 6, K + 1) [m, rad]."""

    def forecast(one: tuple[LinearFlight, NoiseModel]) -> Array:
        flight, model = one
        starts = list_starts(flight.runs, FIT_FORECAST_INTERVAL)
        return settle_own(filter_flight(flight, model.ahead, starts, horizons), prior)

    return map_parallel(forecast, list(zip(flights, noise, strict=True)))


def measure_errors(
    flights: Sequence[LinearFlight],
    noise: Sequence[NoiseModel],
    prior: ParameterPrior,
    horizons: Sequence[float],
) -> float:
    """Return the mean logarithm of the RMS errors of all forecasts, attitude with its weight."""
    errors = np.concatenate(list_errors(flights, noise, prior, horizons))[..., -1]
    sizes = []
    for ahead in np.moveaxis(errors, 1, 0):
        measured = ahead[~np.isnan(ahead).any(axis=1)]
        if len(measured):
            # With a model that diverges, the most that a float holds
            squares = np.minimum(np.abs(measured), 1e100) ** 2
            place, turn = (squares[:, part].sum(axis=1).mean() for part in ERROR_PARTS)
            sizes.append(0.5 * (math.log(place) + ATTITUDE * math.log(turn)))
    return float(np.mean(sizes)) if sizes else math.inf


def choose_horizons(systems: Sequence[FlightSystem]) -> tuple[float, ...]:
    """Return the horizons of forecasts for which some flight is long enough [s]."""
    longest = max((b - a for one in systems for a, b in one.runs), default=0) * GRID_PERIOD
    for horizons in (HORIZONS, SHORT):
        fitting = tuple(one for one in horizons if one + FIRST_START < longest)
        if fitting:
            return fitting
    return ()


def list_starts(runs: Sequence[tuple[int, int]], every: float) -> NDArray[np.int64]:
    """Return the grid points at which forecasts of a flight begin."""
    wait, apart = round(FIRST_START / GRID_PERIOD), round(every / GRID_PERIOD)
    return np.concatenate(
        [np.zeros(0, dtype=np.int64), *(np.arange(a + wait, b, apart) for a, b in runs)]
    )


def settle_own(one: FilteredFlight, prior: ParameterPrior) -> Array:
    """Return errors of forecasts with what the flight's own readings tell up to each start."""
    own = np.flatnonzero(prior.own)
    if not len(own):
        return one.errors
    inner = one.sums[:, own[:, None], own] + np.diag(prior.deviation[own] ** -2.0)
    slopes = np.linalg.solve(inner, one.sums[:, own])
    out: Array = one.errors - np.einsum('shpo,sok->shpk', one.errors[..., own], slopes)
    out[..., own] = 0.0
    return out


def weigh_errors(errors: Array) -> tuple[Array, Array]:
    """
    Return errors of forecasts, shape (S, H, 6, K + 1), by their usual size, shape (H, 6).

    Each horizon counts alike. Errors are 0 where unknown.
    """
    left = errors[..., -1]
    measured = np.isfinite(left)
    size = np.zeros(left.shape[1:])
    for part in ERROR_PARTS:
        for h in range(left.shape[1]):
            some = left[:, h, part][measured[:, h, part]]
            # An outlier must not hide the others
            usual = np.median(np.abs(some)) / NOISE_MEDIAN if len(some) else 1.0
            size[h, part] = usual if usual > 0.0 else 1.0
    weight = ERROR_WEIGHTS / size / math.sqrt(left.shape[1])
    far = np.where(measured, np.abs(left) / size, 0.0)
    weight = weight * np.sqrt(ROBUST / np.maximum(far, ROBUST))
    return np.where(measured[..., None], errors * weight[..., None], 0.0), size
