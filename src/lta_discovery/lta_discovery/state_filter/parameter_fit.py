"""
Fit parameters to filtered flights: by the likelihood of every reading, and by forecasts.

The likelihood is efficient where the model is right. On real flights something acts that no model
has, and what explains one reading after the other best need not forecast well. There, errors of
forecasts are fitted, which weigh slow forces as a forecast does.

Parameters that a flight has of its own (its lift, biases of its sensors) are eliminated from the
likelihood; in a forecast they have the values that the readings before it tell.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_discovery.fit.evidence import wrench_floor
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.flights.noise import HALF
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.parallel import map_parallel
from lta_discovery.state_filter.kalman import AXES, filter_flight, FilteredFlight
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight
from lta_discovery.state_filter.motion import SHORTEST
from lta_discovery.state_filter.noise_model import GUESS_LOGARITHMS, NoiseModel
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Array = NDArray[np.float64]

HORIZONS: Final = (1.0, 3.0, 8.0)  # s; of the forecasts
SHORT: Final = (0.4, 0.8, 1.2)  # s; those of flights too short for them
EVERY: Final = 0.75  # s; between the starts of the forecasts of a fit
FIRST_START: Final = 1.0  # s; from the beginning of a run, in which the filter settles
ROUNDS: Final = 10  # most linearizations
HALVED: Final = 6  # most times that a step is halved until the vehicle is possible
WORSE: Final = 0.01  # of the mean logarithm of the errors; tolerated increase of a step
NOISE_OF_MISFIT: Final = 0.5  # nats; tolerated increase of a step
SETTLED: Final = 0.02  # prior deviations; a fit ends with a shorter step
LONGEST: Final = 1.0  # prior deviations; of a step, beyond which the linearization is not trusted
ATTITUDE: Final = 0.5  # weight of an error of attitude by that of position, each in its usual size
ROBUST: Final = 4.5  # usual sizes; larger errors have a linear cost instead of a quadratic one
BLOCK: Final = 10.0  # s; errors further apart than this are independent
LEARNED: Final = 1500  # grid points of all flights from which the forces are learned; 60 s
ITERATIONS: Final = 12  # most steps of the search for the noise
LEARNING: Final = (1, 4)  # rounds before which the noise is learned
# Standard deviation of the logarithm of each learned number of the noise about its first guess
SPREAD: Final = np.array([1.0] * 4 + [0.3] + [3.0] * 6 + [0.7] * 2)
FURTHEST: Final = 2.5  # of these deviations; bounds of the search
SENSOR: Final = 5  # of these numbers, the first, that belong to the sensors of a flight


@final
class ParameterPrior(NamedTuple):
    """Assumptions about parameters before a fit, relative to the vehicle file, each (K,)."""

    deviation: Array
    low: Array
    high: Array
    own: NDArray[np.bool_]  # whether each flight has it of its own

    @classmethod
    def of(cls, parameters: Sequence[FreeParameter]) -> 'ParameterPrior':
        """Return the assumptions of parameters, whose tolerances are their deviations."""
        return cls(
            np.array([one.tolerance for one in parameters]),
            np.array([one.low for one in parameters]),
            np.array([one.high for one in parameters]),
            np.array([one.per_flight for one in parameters], dtype=np.bool_),
        )

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which parameters the flights share."""
        free: NDArray[np.bool_] = (self.deviation > 0.0) & ~self.own
        return free

    def step(self, values: Array, inner: Array, pull: Array) -> Array:
        """Return the values after a bounded Newton step."""
        free = self.free
        out = values.copy()
        change = np.linalg.solve(inner[np.ix_(free, free)], pull[free])
        longest = LONGEST * self.deviation[free]
        out[free] = np.clip(
            values[free] + np.clip(change, -longest, longest), self.low[free], self.high[free]
        )
        return out


@final
@dataclass(frozen=True, slots=True)
class ParameterFit:
    """Parameters fitted to flights."""

    values: Array  # shared, relative to the vehicle file, shape (K,)
    covariance: Array  # shape (K, K)
    # What each flight has of its own, and its covariance; 0 for shared parameters
    own: tuple[tuple[Array, Array], ...]
    noise: tuple[NoiseModel, ...]  # of each flight
    evidence: float  # log density of the readings, without a constant [nats]


def linearize_all(
    systems: Sequence[FlightSystem], nominal: NominalVehicle, values: Array
) -> list[LinearFlight]:
    """Linearize flights about shared values; raise `BadInput` for an impossible vehicle."""
    with np.errstate(over='ignore', invalid='ignore'):
        out = map_parallel(lambda one: one.linearize(nominal, values), systems)
    if not all(one.is_finite for one in out):
        raise BadInput('The model of the vehicle gives no finite motion.')
    return out


def fit_likelihood(
    systems: Sequence[FlightSystem],
    nominal: NominalVehicle,
    begin: Array,
    noise: Sequence[NoiseModel],
    rounds: int = ROUNDS,
    learning: Sequence[int] = LEARNING,
) -> ParameterFit:
    """
    Fit parameters to all readings by Gauss-Newton steps; the noise is learned on the way.

    `learning`: rounds before which the noise is learned.
    """
    prior, values, noise = ParameterPrior.of(systems[0].parameters), begin, list(noise)
    flights = linearize_all(systems, nominal, values)
    for number in range(rounds):
        if number in learning:
            noise = learn_noise(flights, prior, values, noise)
        inner, pull, misfit, _ = _sum_likelihoods(_filter_all(flights, noise), prior, values)
        after, there = _advance(systems, nominal, prior, values, inner, pull)
        # From afar, bounded steps need not lower the misfit one by one
        for _ in range(HALVED if number > max(learning, default=rounds) else 0):
            reached = _sum_likelihoods(_filter_all(there, noise), prior, after).misfit
            if reached < misfit + NOISE_OF_MISFIT:
                break
            after = 0.5 * (values + after)
            there = linearize_all(systems, nominal, after)
        step = np.abs(after - values)[prior.free] / prior.deviation[prior.free]
        values, flights = after, there
        if number >= max(learning, default=0) and np.all(step < SETTLED):
            break
    inner, _, _, evidence = _sum_likelihoods(_filter_all(flights, noise), prior, values)
    covariance = _spread_out(np.linalg.inv(inner[np.ix_(prior.free, prior.free)]), prior.free)
    filtered = _filter_all(flights, noise)
    own = tuple(_estimate_own(one.products, prior, covariance) for one in filtered)
    return ParameterFit(values, covariance, own, tuple(noise), evidence)


def _advance(
    systems: Sequence[FlightSystem],
    nominal: NominalVehicle,
    prior: ParameterPrior,
    values: Array,
    inner: Array,
    pull: Array,
) -> tuple[Array, list[LinearFlight]]:
    """Return the values after a step that gives a possible vehicle, and the flights there."""
    after = prior.step(values, inner, pull)
    for _ in range(HALVED):
        try:
            return after, linearize_all(systems, nominal, after)
        except BadInput:
            after = 0.5 * (values + after)
    return values, linearize_all(systems, nominal, values)


def _filter_all(
    flights: Sequence[LinearFlight], noise: Sequence[NoiseModel]
) -> list[FilteredFlight]:
    """Filter flights, each with its noise."""
    return map_parallel(lambda one: filter_flight(*one), list(zip(flights, noise, strict=True)))


def _spread_out(inner: NDArray[np.floating], free: NDArray[np.bool_]) -> Array:
    """Return a matrix of the free parameters among all."""
    out = np.zeros((len(free), len(free)))
    out[np.ix_(free, free)] = inner
    return out


@final
class _LikelihoodSum(NamedTuple):
    """Likelihood of all readings about some values of the parameters."""

    inner: Array  # precision of the parameters, shape (K, K)
    pull: Array  # shape (K,)
    misfit: float  # negative log density at the values themselves [nats]
    evidence: float  # log density whatever the parameters [nats]


def _sum_likelihoods(
    filtered: Sequence[FilteredFlight], prior: ParameterPrior, values: Array
) -> _LikelihoodSum:
    """Return the likelihood of all readings about some values."""
    wide = np.where(prior.deviation > 0.0, prior.deviation, 1.0)
    inner, pull = np.diag(wide**-2.0), -values / wide**2.0
    evidence = -0.5 * float(np.sum((values / wide)[prior.free] ** 2))
    evidence -= float(np.sum(np.log(wide[prior.free])))
    for one in filtered:
        products, more = _eliminate_own(one.products, prior)
        evidence += more - 0.5 * one.log_determinant - 0.5 * float(products[-1, -1])
        inner += products[:-1, :-1]
        pull -= products[:-1, -1]
    misfit = -evidence
    free = np.ix_(prior.free, prior.free)
    change = np.linalg.solve(inner[free], pull[prior.free])
    evidence += 0.5 * float(pull[prior.free] @ change)
    evidence -= 0.5 * float(np.linalg.slogdet(inner[free])[1])
    return _LikelihoodSum(inner, pull, misfit, evidence)


def _eliminate_own(products: Array, prior: ParameterPrior) -> tuple[Array, float]:
    """Return products without what the flight has of its own, and the evidence of that."""
    own = np.flatnonzero(prior.own)
    if not len(own):
        return products, 0.0
    inner = products[np.ix_(own, own)] + np.diag(prior.deviation[own] ** -2.0)
    across = products[own]
    left = products - across.T @ np.linalg.solve(inner, across)
    size = np.linalg.slogdet(inner)[1] + 2.0 * np.sum(np.log(prior.deviation[own]))
    return left, -0.5 * float(size)


def _estimate_own(
    products: Array, prior: ParameterPrior, covariance: Array
) -> tuple[Array, Array]:
    """
    Return what a flight has of its own, and its covariance, 0 for other parameters.

    `covariance`: of the shared parameters, whose error its estimate shares.
    """
    own = np.flatnonzero(prior.own)
    values = np.zeros(len(prior.own))
    inner = products[np.ix_(own, own)] + np.diag(prior.deviation[own] ** -2.0)
    values[own] = -np.linalg.solve(inner, products[own, -1])
    slopes = np.linalg.solve(inner, products[own, :-1] * prior.free)
    spread = np.linalg.inv(inner) + slopes @ covariance @ slopes.T
    return values, _spread_out(spread, prior.own)


def learn_noise(
    flights: Sequence[LinearFlight],
    prior: ParameterPrior,
    values: Array,
    noise: Sequence[NoiseModel],
) -> list[NoiseModel]:
    """
    Return the noise under which the readings are most probable, whatever the parameters.

    Unexplained forces are those of all flights. Each flight has sensor errors of its own.
    """
    parts = _shorten(flights)
    together = _maximize(parts, prior, values, list(noise), np.arange(len(SPREAD)))
    forces = together[0].logarithms[SENSOR:]
    models = [
        one.with_logarithms(np.concatenate([one.logarithms[:SENSOR], forces])) for one in together
    ]

    def refine(one: tuple[LinearFlight, NoiseModel]) -> NoiseModel:
        return _maximize([one[0]], prior, values, [one[1]], np.arange(SENSOR))[0]

    return map_parallel(refine, list(zip(parts, models, strict=True)))


def _shorten(flights: Sequence[LinearFlight]) -> list[LinearFlight]:
    """Return the first part of each flight, which is enough to learn the noise."""
    most = max(LEARNED // len(flights), SHORTEST)
    return [replace(one, runs=_limit_runs(one.runs, most)) for one in flights]


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
) -> list[NoiseModel]:
    """Return the most probable noise, of which some numbers are changed alike in all flights."""
    first = GUESS_LOGARITHMS.copy()
    first[SENSOR:] = NoiseModel.guess_wrench(flights[0].nominal)
    begin = [one.logarithms for one in noise]

    def build(change: Array) -> list[NoiseModel]:
        more = np.zeros(len(SPREAD))
        more[which] = change
        return [one.with_logarithms(at + more) for one, at in zip(noise, begin, strict=True)]

    def cost(change: Array) -> float:
        filtered = _filter_all(flights, build(change))
        off = (begin[0] - first)[which] + change
        doubt = 0.5 * float(np.sum((off / SPREAD[which]) ** 2))
        return doubt - _sum_likelihoods(filtered, prior, values).evidence

    limit = FURTHEST * SPREAD[which]
    bounds = np.stack([-limit, limit]) - (begin[0] - first)[which]
    # No model of a vehicle is better than the floor of its forces, however quiet a flight
    least = np.full(len(SPREAD), -np.inf)
    least[SENSOR : SENSOR + AXES] = np.log(wrench_floor(flights[0].nominal))
    bounds = np.maximum(bounds, (least - begin[0])[which])
    best = minimize(
        cost, np.zeros(len(which)), method='L-BFGS-B', bounds=list(zip(*bounds, strict=True)),
        options={'maxiter': ITERATIONS, 'ftol': 1e-6},
    )  # fmt: skip
    return build(best.x)


def fit_forecasts(
    systems: Sequence[FlightSystem],
    nominal: NominalVehicle,
    begin: Array,
    noise: Sequence[NoiseModel],
    horizons: Sequence[float] = HORIZONS,
    rounds: int = ROUNDS,
) -> ParameterFit:
    """Fit parameters to the errors of forecasts by Gauss-Newton steps, with given noise."""
    prior, values = ParameterPrior.of(systems[0].parameters), begin
    flights = linearize_all(systems, nominal, values)
    now = _sum_forecasts(flights, noise, prior, values, horizons)
    for _ in range(rounds):
        after, there = _advance(systems, nominal, prior, values, now.inner, now.pull)
        for _ in range(HALVED):
            try:
                next_sum = _sum_forecasts(there, noise, prior, after, horizons)
                if next_sum.cost < now.cost + WORSE:
                    break
            except np.linalg.LinAlgError:
                pass  # a vehicle so unstable that a filter loses it
            after = 0.5 * (values + after)
            there = linearize_all(systems, nominal, after)
        else:
            break
        step = np.abs(after - values)[prior.free] / prior.deviation[prior.free]
        values, flights, now = after, there, next_sum
        if np.all(step < SETTLED):
            break
    inner, blocks = now.inner, now.blocks
    filtered = _filter_all(flights, noise)
    free = np.ix_(prior.free, prior.free)
    # Errors of neighbouring forecasts are alike: the scatter of independent blocks tells how well
    # the values are known (White, Econometrica 48, 1980). Few blocks tell nothing of some
    # directions, so the curvature is added.
    scatter = blocks.T @ blocks + inner
    inverse = np.linalg.inv(inner[free])
    covariance = _spread_out(inverse @ scatter[free] @ inverse, prior.free)
    own = tuple(_estimate_own(one.products, prior, covariance) for one in filtered)
    return ParameterFit(values, covariance, own, tuple(noise), -math.inf)


@final
class _ForecastSum(NamedTuple):
    """Errors of forecasts about some parameters."""

    inner: Array  # precision of the parameters, shape (K, K)
    pull: Array  # shape (K,)
    blocks: Array  # pull of each block of independent errors, shape (B, K)
    cost: float  # mean logarithm of the usual errors


def _sum_forecasts(
    flights: Sequence[LinearFlight],
    noise: Sequence[NoiseModel],
    prior: ParameterPrior,
    values: Array,
    horizons: Sequence[float],
) -> _ForecastSum:
    """Return the errors of all forecasts about some values."""
    errors, places = [], []
    for f, (flight, model) in enumerate(zip(flights, noise, strict=True)):
        starts = list_starts(flight.runs, EVERY)
        one = filter_flight(flight, model, starts, horizons)
        errors.append(settle_own(one, prior))
        places += [(f, int(one * PERIOD / BLOCK)) for one in starts]
    weighed, size = weigh_errors(np.concatenate(errors))
    wide = np.where(prior.deviation > 0.0, prior.deviation, 1.0)
    inner, pull = np.diag(wide**-2.0), -values / wide**2
    count = len(values)
    table = weighed.reshape(len(weighed), -1, count + 1)
    pulls = -np.einsum('spk,sp->sk', table[..., :-1], table[..., -1])
    flat = table[..., :-1].reshape(-1, count)
    inner += flat.T @ flat
    block = np.unique(places, axis=0, return_inverse=True)[1].ravel()
    blocks = np.zeros((block.max() + 1, count))
    np.add.at(blocks, block, pulls)
    cost = float(np.mean(np.log(size)))
    return _ForecastSum(inner, pull + pulls.sum(axis=0), blocks, cost)


def choose_horizons(systems: Sequence[FlightSystem]) -> tuple[float, ...]:
    """Return the horizons of forecasts for which some flight is long enough. [s]"""
    longest = max((b - a for one in systems for a, b in one.runs), default=0) * PERIOD
    for horizons in (HORIZONS, SHORT):
        fitting = tuple(one for one in horizons if one + FIRST_START < longest)
        if fitting:
            return fitting
    return ()


def list_starts(runs: Sequence[tuple[int, int]], every: float) -> NDArray[np.int64]:
    """Return the grid points at which forecasts of a flight begin."""
    wait, apart = round(FIRST_START / PERIOD), round(every / PERIOD)
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
    for part in (slice(0, 3), slice(3, 6)):
        for h in range(left.shape[1]):
            some = left[:, h, part][measured[:, h, part]]
            # An outlier must not hide the others
            usual = np.median(np.abs(some)) / HALF if len(some) else 1.0
            size[h, part] = usual if usual > 0.0 else 1.0
    weight = np.array([1.0] * 3 + [ATTITUDE] * 3) / size / math.sqrt(left.shape[1])
    far = np.where(measured, np.abs(left) / size, 0.0)
    weight = weight * np.sqrt(ROBUST / np.maximum(far, ROBUST))
    return np.where(measured[..., None], errors * weight[..., None], 0.0), size
