# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Learn the noise of the tracker of each flight, and the forces that nothing explains."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from lta_discovery.flights.measured_flight import SHORTEST_RUN
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.replay import AXIS_COUNT
from lta_discovery.state_filter.likelihood import (
    build_moments_root,
    ParameterPrior,
    sum_likelihoods,
)
from lta_discovery.state_filter.linear_flight import LinearFlight
from lta_discovery.state_filter.noise_model import GUESS_LOGARITHMS, NoiseModel, wrench_floor
from lta_discovery.state_filter.smoothing import (
    filter_run,
    FilteredRun,
    go_back,
    log_slopes,
    sum_runs,
)
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Array = NDArray[np.float64]

LEARNED: Final = 1500  # grid points of all flights from which the forces are learned; 60 s
ITERATIONS: Final = 100  # most steps of the search
# Standard deviation of the logarithm of each learned number about its first guess
SPREAD: Final = np.array([1.0] * 4 + [0.3] + [3.0] * 6 + [0.7] * 2)
FURTHEST: Final = 2.5  # of these deviations; bounds of the search
# About how well flights tell the logarithms, the unit of the search: white noise from thousands of
# readings, slow forces from tens of their memories
NOISE_UNITS: Final = np.array([0.01] * 2 + [0.05] * 2 + [0.1] * 7 + [0.25] * 2)
SETTLED_NOISE_GAIN: Final = 0.05  # nats; the search ends with a step that gains less
SENSOR: Final = 5  # of these numbers, the first, that belong to the sensors of a flight


def learn_noise(
    flights: Sequence[LinearFlight],
    prior: ParameterPrior,
    values: Array,
    noise: Sequence[NoiseModel],
    is_near: bool = False,
) -> list[NoiseModel]:
    """
    Return the noise under which the readings are most probable, whatever the parameters.

    `is_near`: whether the parameters are near their values, beyond which the model is not linear.
    Unexplained forces are those of all flights. Each flight has sensor errors of its own. The
    first part of each flight is enough.
    """
    parts = _shorten(flights)
    together = _maximize(parts, prior, values, noise, np.arange(len(SPREAD)), is_near)
    forces = together[0].logarithms[SENSOR:]
    models = [
        one.with_logarithms(np.concatenate([one.logarithms[:SENSOR], forces])) for one in together
    ]

    def refine(one: tuple[LinearFlight, NoiseModel]) -> NoiseModel:
        return _maximize([one[0]], prior, values, [one[1]], np.arange(SENSOR), is_near)[0]

    return map_parallel(refine, list(zip(parts, models, strict=True)))


def log_prior_of_noise(noise: Sequence[NoiseModel], nominal: NominalVehicle) -> float:
    """Return the logarithm of the prior density of noise, the same for all flights [nats]."""
    mean = np.mean([one.logarithms for one in noise], axis=0)
    return -0.5 * float(np.sum(((mean - _guess(nominal)) / SPREAD) ** 2))


def _guess(nominal: NominalVehicle) -> Array:
    """Return the logarithms of the learned numbers before any reading."""
    return np.concatenate([GUESS_LOGARITHMS[:SENSOR], NoiseModel.guess_wrench(nominal)])


def _shorten(flights: Sequence[LinearFlight]) -> list[LinearFlight]:
    """Return the first part of each flight, which is enough to learn the noise."""
    most = max(LEARNED // len(flights), SHORTEST_RUN)
    parts = [_limit_runs(one.runs, most) for one in flights]
    return [
        replace(one, runs=runs, begun=one.begun[: len(runs)])
        for one, runs in zip(flights, parts, strict=True)
    ]


def _limit_runs(runs: Sequence[tuple[int, int]], most: int) -> list[tuple[int, int]]:
    """Return the runs up to a number of grid points."""
    out, left = [], most
    for begin, end in runs:
        if left > 0:
            out.append((begin, min(end, begin + left)))
            left -= end - begin
    return out


def _maximize(
    flights: Sequence[LinearFlight],
    prior: ParameterPrior,
    values: Array,
    noise: Sequence[NoiseModel],
    which: NDArray[np.int64],
    is_near: bool,
) -> list[NoiseModel]:
    """Return the most probable noise, of which some numbers are changed alike in all flights."""
    first = _guess(flights[0].nominal)
    begin = [one.logarithms for one in noise]

    def build(change: Array) -> list[NoiseModel]:
        more = np.zeros(len(SPREAD))
        more[which] = change
        return [one.with_logarithms(at + more) for one, at in zip(noise, begin, strict=True)]

    def measure(change: Array) -> tuple[float, Array]:
        """Return the cost and its slopes."""
        models = build(change)
        evidence, slopes = _measure_evidence(flights, prior, values, models, is_near)
        off = (begin[0] - first)[which] + change
        cost = 0.5 * float(np.sum((off / SPREAD[which]) ** 2)) - evidence
        return cost, off / SPREAD[which] ** 2 - slopes[which]

    limit = FURTHEST * SPREAD[which]
    bounds = np.stack([-limit, limit]) - (begin[0] - first)[which]
    # No model of a vehicle is better than the floor of its forces, however quiet a flight
    least = np.full(len(SPREAD), -np.inf)
    least[SENSOR : SENSOR + AXIS_COUNT] = np.log(wrench_floor(flights[0].nominal))
    bounds = np.maximum(bounds, (least - begin[0])[which])
    start = np.clip(np.zeros(len(which)), *bounds)
    unit = NOISE_UNITS[which]

    def measure_scaled(part: Array) -> tuple[float, Array]:
        cost, slopes = measure(start + unit * part)
        return cost, unit * slopes

    best = minimize(
        measure_scaled, np.zeros(len(which)), method='SLSQP', jac=True,
        bounds=list(zip(*((bounds - start) / unit), strict=True)),
        options={'maxiter': ITERATIONS, 'ftol': SETTLED_NOISE_GAIN},
    )  # fmt: skip
    return build(start + unit * best.x)


def _measure_evidence(
    flights: Sequence[LinearFlight],
    prior: ParameterPrior,
    values: Array,
    noise: Sequence[NoiseModel],
    is_near: bool,
) -> tuple[float, Array]:
    """Return the evidence of some flights, and its slopes by the learned numbers of the noise."""

    def filter_whole(one: tuple[LinearFlight, NoiseModel]) -> list[FilteredRun]:
        return [filter_run(*one, k) for k in range(len(one[0].runs))]

    runs = map_parallel(filter_whole, list(zip(flights, noise, strict=True)))
    filtered = [sum_runs(each, len(values) + 1) for each in runs]
    sums = sum_likelihoods(filtered, prior, values)
    free = np.ix_(prior.free, prior.free)
    mean = np.zeros(len(values))
    if not is_near:
        mean[prior.free] = np.linalg.solve(sums.inner[free], sums.pull[prior.free])
    root = np.linalg.inv(np.linalg.cholesky(sums.inner[free])).T

    def go_back_whole(f: int) -> Array:
        mix = build_moments_root(filtered[f].products, prior, mean, root)
        slopes = np.zeros(len(SPREAD))
        for k, run in enumerate(runs[f]):
            mixed = run._replace(innovations=run.innovations @ mix, states=run.states @ mix)
            slopes += log_slopes(noise[f], go_back(flights[f], noise[f], k, mixed)[2])
        return slopes

    evidence = sums.near_evidence if is_near else sums.evidence
    return evidence, np.sum(map_parallel(go_back_whole, range(len(flights))), axis=0)
