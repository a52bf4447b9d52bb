# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Choose how large unexplained forces are and how long they last, so that forecasts are best."""

from collections.abc import Sequence
from dataclasses import replace
import functools
import math
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.state_filter.forecast_sums import measure_errors
from lta_discovery.state_filter.likelihood import linearize_all, ParameterPrior
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight
from lta_discovery.state_filter.noise_model import average_noise, NoiseModel
import numpy as np

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
