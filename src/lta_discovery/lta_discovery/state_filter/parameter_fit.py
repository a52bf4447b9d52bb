# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fit parameters to filtered flights: by the likelihood of every reading, and by forecasts.

The likelihood is efficient where the model is right. On real flights something acts that no model
has, and what explains one reading after the other best need not forecast well. There, errors of
forecasts are fitted, which weigh slow forces as a forecast does. In a forecast, what a flight has
of its own has the values that the readings before it tell.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
import math
from typing import Final, final, Generic, NamedTuple, TypeVar

from lta_config.errors import BadInput
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.parallel import map_parallel
from lta_discovery.state_filter.forecast_noise import (
    BLOCK,
    fit_forecast_noise,
    ForecastSum,
    HORIZONS,
    list_starts,
    sum_forecasts,
)
from lta_discovery.state_filter.kalman import FilteredFlight
from lta_discovery.state_filter.likelihood import (
    estimate_own,
    filter_all,
    LikelihoodSum,
    linearize_all,
    list_pulls,
    ParameterPrior,
    SIMULATION_RAN_AWAY,
    spread_out,
    sum_likelihoods,
)
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight
from lta_discovery.state_filter.noise_fit import learn_noise
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.smoothing import smooth_flight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Matrix = NDArray[np.floating]  # as NumPy types an inverse
Sums = TypeVar('Sums', LikelihoodSum, ForecastSum)

LEAST_PULLS: Final = 4  # pieces of flights; the scatter of fewer tells nothing
MOST_LINEARIZATIONS: Final = 10  # most linearizations
FORECAST_NOISES: Final = 2  # times that a fit to forecasts chooses its noise
FIT_NOISE_ROUNDS: Final = (1, 4)  # rounds before which the noise is learned
# Prior deviations; longest step of a parameter from afar, where a model is not linear
LONGEST_FIT_STEP: Final = 1.0
DAMPINGS: Final = (0.0, 0.1, 1.0, 10.0, 100.0)  # of a step, until it helps
MISFIT_RISE: Final = 0.5  # nats; tolerated increase of the misfit in a step
# Of the mean logarithm of the errors; a step of a fit to forecasts that raises it more is damped
ERROR_RISE: Final = 0.01
ERROR_GAIN: Final = 0.002  # of it; a fit to forecasts ends with a step that gains less
SHORT_MOVE: Final = 0.02  # prior deviations; a shorter step is not damped further
SETTLED_GAIN: Final = 0.02  # nats; a fit near its end ends with a step that gains less
# Nats; the same from afar. Then all parameters together are within about their deviation
SETTLED_GAIN_FROM_AFAR: Final = 1.0


@final
@dataclass(frozen=True, slots=True)
class ParameterFit:
    """Parameters fitted to flights."""

    values: Array  # shared, relative to the vehicle file, shape (K,)
    covariance: Array  # shape (K, K)
    # Standard deviations divided by those that independent errors would give, shape (K,)
    excess: Array
    # What each flight has of its own, and its covariance; 0 for shared parameters
    own: tuple[tuple[Array, Array], ...]
    noise: tuple[NoiseModel, ...]  # of each flight
    # Log density of the readings, without a constant [nats]; of a fit to forecasts the negative
    # mean logarithm of their usual errors
    evidence: float
    flights: tuple[LinearFlight, ...]  # linearized about the values


@final
class _Point(NamedTuple, Generic[Sums]):
    """Parameters, the flights linearized about them, and what these tell."""

    values: Array
    flights: list[LinearFlight]
    sums: Sums


@final
@dataclass(frozen=True, slots=True)
class _Search(Generic[Sums]):
    """A search for parameters by Gauss-Newton steps."""

    systems: Sequence[FlightSystem]
    nominal: NominalVehicle
    prior: ParameterPrior
    evaluate: Callable[[Sequence[LinearFlight], Array], Sums]
    longest: float = LONGEST_FIT_STEP  # of an undamped step [prior deviations]

    def look(self, values: Array) -> _Point[Sums]:
        """Linearize about some values; raise `BadInput` if the vehicle is impossible there."""
        try:
            flights = linearize_all(self.systems, self.nominal, values)
            return _Point(values, flights, self.evaluate(flights, values))
        except np.linalg.LinAlgError:
            # So unstable that a filter loses it
            raise BadInput(SIMULATION_RAN_AWAY) from None

    def step(self, at: _Point[Sums], limit: float) -> _Point[Sums] | None:
        """Return a point whose cost is below a limit, after a step; None if no step gets there."""
        for damping in DAMPINGS:
            longest = self.longest if damping == 0.0 else math.inf
            after = at.sums.step(self.prior, at.values, damping, longest)
            try:
                there = self.look(after)
                if damping == 0.0 and longest == math.inf and not there.sums.cost < limit:
                    # What can be scaled together lies along a curved valley: a step along it ends
                    # on its slope, and the next one on its floor
                    there = self.look(there.sums.step(self.prior, after, 0.0, longest))
            except BadInput:
                continue
            if there.sums.cost < limit:
                return there
            if self.has_settled(at.values, after):
                break
        return None

    def expect_gain(self, at: _Point[Sums]) -> float:
        """Return by how much the best step lowers the cost, as far as the flights are linear."""
        after = at.sums.step(self.prior, at.values, 0.0, math.inf)
        return 0.5 * float((at.sums.pull * self.prior.free) @ (after - at.values))

    def has_settled(self, before: Array, after: Array) -> bool:
        """Return whether no parameter has moved far."""
        free = self.prior.free
        return bool(np.all(np.abs(after - before)[free] < SHORT_MOVE * self.prior.deviation[free]))


def fit_likelihood(
    systems: Sequence[FlightSystem],
    nominal: NominalVehicle,
    begin: Array,
    noise: Sequence[NoiseModel],
    rounds: int = MOST_LINEARIZATIONS,
    learning: Sequence[int] = FIT_NOISE_ROUNDS,
    is_near: bool = False,
) -> ParameterFit:
    """
    Fit parameters to all readings; the noise is learned on the way.

    `learning`: rounds before which the noise is learned. `is_near`: whether the values are near
    the best ones, so that every step lowers the misfit, and the noise is learned where the values
    have settled, as often as `learning` has rounds.
    Raise `BadInput` if the model diverges with the values to begin with.
    """
    prior = ParameterPrior.of(systems[0].parameters)

    def evaluate(flights: Sequence[LinearFlight], values: Array) -> LikelihoodSum:
        return sum_likelihoods(filter_all(flights, noise), prior, values)

    # Limits on some parameters bend a step, which near the best values need not end well
    longest = math.inf if is_near else LONGEST_FIT_STEP
    search = _Search(systems, nominal, prior, evaluate, longest)
    point, left, has_settled = search.look(begin), list(learning), False
    for number in range(rounds):
        if left and (has_settled or (number >= left[0] and not is_near)):
            before, noise = noise, learn_noise(point.flights, prior, point.values, noise, is_near)
            sums = evaluate(point.flights, point.values)
            if is_near and sums.near_evidence < point.sums.near_evidence:
                # What suits the part that it was learned from does not suit the rest
                noise = before
            else:
                point = point._replace(sums=sums)
            left, has_settled = left[1:], False
        # Prior deviations of what may be large are many times what the flights leave open
        if is_near and search.expect_gain(point) < SETTLED_GAIN:
            has_settled = True
        else:
            # From afar, bounded steps need not lower the misfit one by one
            lower = is_near or (bool(learning) and not left)
            after = search.step(point, point.sums.cost + MISFIT_RISE if lower else math.inf)
            settled = SETTLED_GAIN if is_near else SETTLED_GAIN_FROM_AFAR
            has_settled = after is None or point.sums.cost - after.sums.cost < settled
            point = point if after is None else after
        if has_settled and not left:
            break
    # From afar, where a fit ends early, pulls are no scatter
    starts = [list_starts(one.runs, BLOCK) for one in point.flights] if is_near else None
    filtered = filter_all(point.flights, noise, starts)

    def spread(inverse: Matrix) -> Matrix:
        if not is_near:
            return inverse
        pulls = np.concatenate([list_pulls(one, prior) for one in filtered])[:, prior.free]
        if len(pulls) < LEAST_PULLS:
            return inverse
        pulls = pulls - pulls.mean(axis=0)
        # What the model lacks pulls a parameter for longer than noise does, as moving air pulls a
        # wind. Then independent pieces scatter more than their curvature tells (White,
        # Econometrica 50, 1982).
        precision = pulls.T @ pulls + np.diag(prior.precision[prior.free])
        scatter = inverse @ precision @ inverse
        wider = np.sqrt(np.maximum(np.diag(scatter) / np.diag(inverse), 1.0))
        covariance: Matrix = inverse * np.outer(wider, wider)
        return covariance

    return _complete(point, prior, filtered, noise, spread, point.sums.near_evidence)


def fit_forecasts(
    systems: Sequence[FlightSystem],
    nominal: NominalVehicle,
    begin: Array,
    noise: Sequence[NoiseModel],
    horizons: Sequence[float] = HORIZONS,
    rounds: int = MOST_LINEARIZATIONS,
) -> ParameterFit:
    """
    Fit parameters, and how forces that nothing explains last, to the errors of forecasts.

    `noise`: of each flight, to begin with. Errors as `fit_likelihood`.
    """
    prior = ParameterPrior.of(systems[0].parameters)

    def evaluate(flights: Sequence[LinearFlight], values: Array) -> ForecastSum:
        return sum_forecasts(flights, noise, prior, values, horizons)

    search = _Search(systems, nominal, prior, evaluate)
    point = search.look(begin)
    for _ in range(FORECAST_NOISES):
        noise = fit_forecast_noise(point.flights, noise, prior, horizons)
        point = point._replace(sums=evaluate(point.flights, point.values))
        for _ in range(rounds):
            after = search.step(point, point.sums.cost + ERROR_RISE)
            # What is left wanders with the weights of the errors
            if after is None or after.sums.cost > point.sums.cost - ERROR_GAIN:
                break
            point = after
    blocks = point.sums.blocks[:, prior.free]

    def spread(inverse: Matrix) -> Matrix:
        # Errors of neighbouring forecasts are alike: the scatter of independent blocks tells how
        # well the values are known (White, Econometrica 48, 1980). Few blocks tell nothing of some
        # directions, so the curvature is added.
        scatter: Matrix = inverse @ blocks.T @ blocks @ inverse + inverse
        return scatter

    filtered = filter_all(point.flights, noise)
    return _complete(point, prior, filtered, noise, spread, -point.sums.cost)


def smooth_systems(
    systems: Sequence[FlightSystem], fit: ParameterFit, forces: Sequence[Array] | None = None
) -> list[FlightSystem]:
    """
    Return flights that are linearized about the most probable motion of a fit.

    `forces`: wrench of its terms in each flight (`FlightSystem.with_terms`), shape (n, 6).
    """

    def smooth(k: int) -> FlightSystem:
        flight = fit.flights[k]
        smooth = smooth_flight(flight, fit.noise[k], fit.own[k][0])
        wrench = smooth.wrench if forces is None else smooth.wrench + forces[k]
        return systems[k].with_motion(smooth.motion, wrench, flight.nominal)

    return map_parallel(smooth, range(len(systems)))


def _complete(
    point: _Point[Sums],
    prior: ParameterPrior,
    filtered: Sequence[FilteredFlight],
    noise: Sequence[NoiseModel],
    spread: Callable[[Matrix], Matrix],
    evidence: float,
) -> ParameterFit:
    """Return a fit, and what flights have alone; `spread`: covariance by the inverse curvature."""
    inverse = np.linalg.inv(point.sums.inner[np.ix_(prior.free, prior.free)])
    inner = spread(inverse)
    excess = np.ones(len(point.values))
    excess[prior.free] = np.sqrt(np.diag(inner) / np.diag(inverse))
    covariance = spread_out(inner, prior.free)
    own = tuple(estimate_own(one.products, prior, covariance) for one in filtered)
    return ParameterFit(
        point.values, covariance, excess, own, tuple(noise), evidence, tuple(point.flights)
    )
