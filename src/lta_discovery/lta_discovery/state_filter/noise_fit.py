"""Learn the noise of the tracker of each flight, and the forces that nothing explains."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

from lta_discovery.fit.evidence import wrench_floor
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.parallel import map_parallel
from lta_discovery.state_filter.kalman import AXES
from lta_discovery.state_filter.likelihood import (
    filter_all,
    ParameterPrior,
    sum_likelihoods,
)
from lta_discovery.state_filter.linear_flight import LinearFlight
from lta_discovery.state_filter.motion import SHORTEST
from lta_discovery.state_filter.noise_model import GUESS_LOGARITHMS, NoiseModel
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Array = NDArray[np.float64]

LEARNED: Final = 1500  # grid points of all flights from which the forces are learned; 60 s
ITERATIONS: Final = 12  # most steps of the search
# Standard deviation of the logarithm of each learned number about its first guess
SPREAD: Final = np.array([1.0] * 4 + [0.3] + [3.0] * 6 + [0.7] * 2)
FURTHEST: Final = 2.5  # of these deviations; bounds of the search
NUDGE: Final = 1e-3  # of a number in the unit of its width, for a slope
BEND: Final = 0.05  # of the prior deviation of a number, for a curvature
SETTLED: Final = 1e-7  # of the cost; the search ends at a smaller gain
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
    """Return the logarithm of the prior density of noise, the same for all flights. [nats]"""
    mean = np.mean([one.logarithms for one in noise], axis=0)
    return -0.5 * float(np.sum(((mean - _guess(nominal)) / SPREAD) ** 2))


def _guess(nominal: NominalVehicle) -> Array:
    """Return the logarithms of the learned numbers before any reading."""
    return np.concatenate([GUESS_LOGARITHMS[:SENSOR], NoiseModel.guess_wrench(nominal)])


def _shorten(flights: Sequence[LinearFlight]) -> list[LinearFlight]:
    """Return the first part of each flight, which is enough to learn the noise."""
    most = max(LEARNED // len(flights), SHORTEST)
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

    def cost(change: Array) -> float:
        filtered = filter_all(flights, build(change))
        off = (begin[0] - first)[which] + change
        doubt = 0.5 * float(np.sum((off / SPREAD[which]) ** 2))
        sums = sum_likelihoods(filtered, prior, values)
        return doubt - (sums.near_evidence if is_near else sums.evidence)

    limit = FURTHEST * SPREAD[which]
    bounds = np.stack([-limit, limit]) - (begin[0] - first)[which]
    # No model of a vehicle is better than the floor of its forces, however quiet a flight
    least = np.full(len(SPREAD), -np.inf)
    least[SENSOR : SENSOR + AXES] = np.log(wrench_floor(flights[0].nominal))
    bounds = np.maximum(bounds, (least - begin[0])[which])
    start = np.clip(np.zeros(len(which)), *bounds)
    scale = _measure_widths(cost, start, SPREAD[which])
    best = minimize(
        lambda part: cost(start + scale * part), np.zeros(len(which)), method='L-BFGS-B',
        bounds=list(zip(*((bounds - start) / scale), strict=True)),
        options={'maxiter': ITERATIONS, 'ftol': SETTLED, 'eps': NUDGE},
    )  # fmt: skip
    return build(start + scale * best.x)


def _measure_widths(cost: Callable[[Array], float], start: Array, widest: Array) -> Array:
    """
    Return how far each number moves until the cost changes by half a nat, by its curvature.

    In these units the search is well conditioned; the white noise of a thousand readings is known
    much better than a force that acts slowly.
    """
    middle, nudges = cost(start), np.diag(BEND * widest)
    bends = np.array([cost(start + one) - 2.0 * middle + cost(start - one) for one in nudges])
    curvature = np.maximum(bends / (BEND * widest) ** 2, widest**-2.0)
    return 1.0 / np.sqrt(curvature)
