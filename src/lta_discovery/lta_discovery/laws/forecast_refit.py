"""
Refit a law and the tolerances by replay: by the forecasts of the flights that it was found on.

The regression sees the force in each moment; a forecast sums it up over seconds, as whoever flies
the model does. Weights, numbers and tolerances are moved by Gauss-Newton steps on the errors of
these forecasts. The flights are few and the numbers many, so each step is drawn to 0 (ridge
regression), as strongly as is best when training flights teach and confirming ones are forecast,
and vice versa. A step counts only if it is better there than none.
"""

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_discovery.conclusion import FAR
from lta_discovery.fit.bounds import parameter_bounds
from lta_discovery.fit.evidence import Prior
from lta_discovery.forecast.prediction_errors import HORIZONS
from lta_discovery.laws.forecast import DIVERGED, LawForecaster, Prepare
from lta_discovery.parallel import map_parallel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDS: Final = 3  # most Gauss-Newton steps
BETTER: Final = 0.995  # of the score; a step has to be better than this
RIDGES: Final = (0.1, 1.0, 6.0, 36.0, 216.0)  # trial factors on the precision of a step's prior
POSE: Final = (slice(0, 3), slice(3, 6))  # position and attitude among the residuals


@final
@dataclass(frozen=True, slots=True)
class LawModel:
    """A law as a function of its J weights and numbers."""

    start: Array  # shape (J,)
    spread: Array  # standard deviation of the prior about the start, shape (J,)
    prepare: Callable[[Array], Prepare]
    # Change of the wrench in the body frame at the knots of each flight, (S, 6 K, J)
    differentiate: Callable[[Array], Sequence[Array]]


@final
class FittedLaw(NamedTuple):
    """Weights and numbers of a law, and the shared parameters that go with them."""

    weights: Array  # shape (J,)
    shared: Array  # shape (G,)


@final
class ForecastErrors(NamedTuple):
    """Errors of the forecasts of a flight, and their changes."""

    errors: Array  # measured minus predicted, shape (S, H, 6); 0 where unknown or diverging
    columns: Array  # change of the prediction, shape (S, H, 6, J + G)


@final
class ForecastRefit:
    """
    Fit laws to the forecasts of some flights.

    Parameters
    ----------
    makers : sequence of LawForecaster
        Of the flights: `count` training flights first, then the confirming ones.
    prior : Prior
        Of the shared parameters.
    held : ndarray of bool, shape (G,)
        Shared parameters that are not fitted.

    """

    def __init__(
        self, makers: Sequence[LawForecaster], count: int, prior: Prior, held: NDArray[np.bool_]
    ) -> None:
        self._makers, self._count = makers, count
        self._spread = np.where(held, 0.0, np.sqrt(np.diag(prior.covariance)))
        self._bounds = parameter_bounds(makers[0].flight.knobs, prior)

    def score(self, prepare: Prepare | None, at: Array) -> float:
        """Return the error of the forecasts: the geometric mean of position and attitude."""
        return score_forecasts(self._forecast(prepare, at, self._makers))

    def fit(self, model: LawModel, at: Array) -> FittedLaw:
        """Return the refitted law; unchanged if no step helps to forecast other flights."""
        law = FittedLaw(model.start, at)
        best = self.score(model.prepare(law.weights), law.shared)
        for _ in range(ROUNDS):
            errors = self._linearize(model, law)
            crossed, ridge = min((self._cross(model, law, errors, each), each) for each in RIDGES)
            if crossed >= BETTER * best:
                break
            moved = self._step(model, law, errors, ridge)
            now = self.score(model.prepare(moved.weights), moved.shared)
            if now >= best:
                break
            law, best = moved, now
        return law

    def hold_shared(self) -> 'ForecastRefit':
        """Return the same for a law alone: no shared parameter is fitted."""
        out = copy(self)
        out._spread = np.zeros_like(self._spread)
        return out

    def rank_terms(self, model: LawModel, at: Array, count: int) -> list[tuple[float, list[int]]]:
        """
        Return sets of the `count` terms of a law with their scores, from all to one.

        Each lacks the term of the last whose absence the forecasts mind least, after a step of
        the rest about the whole law. Scores are crossed: each side of the flights teaches the
        other's, so that a useless term makes them worse.
        """
        law, every = FittedLaw(model.start, at), list(range(count))
        errors = self._linearize(model, law)
        sets = [(self._cross_linear(model, errors, every), every)]
        while len(every) > 1:
            fewer = [[j for j in every if j != k] for k in every]
            sets.append(min((self._cross_linear(model, errors, some), some) for some in fewer))
            every = sets[-1][1]
        return sets

    def _cross_linear(
        self, model: LawModel, errors: Sequence[ForecastErrors], some: Sequence[int]
    ) -> float:
        """Return the best score after linear steps of some terms, crossed as in `_cross`."""
        weights = len(model.start)
        absent = [j for j in range(weights) if j not in some]
        # Without the others, and with the numbers as they are
        spread = np.concatenate([model.spread, self._spread])
        spread[absent] = 0.0
        rest = [
            ForecastErrors(each.errors + each.columns[..., absent] @ model.start[absent],
                           each.columns)
            for each in errors
        ]  # fmt: skip
        sides = rest[: self._count], rest[self._count :]
        scores = []
        for ridge in RIDGES:
            left = []
            for learn, check in (sides, sides[::-1]):
                change = _solve_step(learn, spread, np.zeros(len(spread)), ridge)
                left += [each.errors - each.columns @ change for each in check]
            scores.append(score_forecasts(left))
        return min(scores)

    def _forecast(
        self, prepare: Prepare | None, at: Array, makers: Sequence[LawForecaster]
    ) -> list[Array]:
        """Return the residuals of the pose, NaN where unknown, of each flight, (S, H, 6)."""
        return map_parallel(lambda each: each.compute_pose_residuals(prepare, at), makers)

    def _cross(
        self, model: LawModel, law: FittedLaw, errors: Sequence[ForecastErrors], ridge: float
    ) -> float:
        """Return the score after steps of which each side of the flights teaches the other's."""
        sides, left = (slice(0, self._count), slice(self._count, None)), []
        for learn, check in (sides, sides[::-1]):
            moved = self._step(model, law, errors[learn], ridge)
            prepare = model.prepare(moved.weights)
            left += self._forecast(prepare, moved.shared, self._makers[check])
        return score_forecasts(left)

    def _step(
        self, model: LawModel, law: FittedLaw, errors: Sequence[ForecastErrors], ridge: float
    ) -> FittedLaw:
        """Return the law after a step, drawn to 0 by a multiple of the prior's precision."""
        spread = np.concatenate([model.spread, self._spread])
        off = np.concatenate([law.weights - model.start, np.zeros(len(law.shared))])
        change = _solve_step(errors, spread, off, ridge)
        count = len(model.start)
        shared = law.shared + change[count:]
        knobs = len(self._bounds[0])
        shared[:knobs] = np.clip(shared[:knobs], *self._bounds)
        return FittedLaw(law.weights + change[:count], shared)

    def _linearize(self, model: LawModel, law: FittedLaw) -> list[ForecastErrors]:
        """Return the errors of each flight about a law."""
        prepare, bases = model.prepare(law.weights), model.differentiate(law.weights)

        def linearize_flight(one: tuple[LawForecaster, Array]) -> ForecastErrors:
            maker, basis = one
            left, columns, pushed = maker.linearize_pose(prepare, law.shared, self._spread > 0.0)
            with_law = np.einsum('shck,skj->shcj', pushed, basis[-len(left) :])
            every = np.concatenate([with_law, columns], axis=-1)
            # A forecast that diverges says nothing about the direction of a step
            usable = (np.abs(left) < DIVERGED) & np.isfinite(every).all(axis=-1)
            return ForecastErrors(
                np.where(usable, left, 0.0), np.where(usable[..., None], every, 0.0)
            )

        return map_parallel(linearize_flight, list(zip(self._makers, bases, strict=True)))


def _solve_step(
    errors: Sequence[ForecastErrors], spread: Array, off: Array, ridge: float
) -> Array:
    """
    Return the change of weights, numbers and shared parameters that forecasts best, (J + G,).

    `spread`, shape (J + G,): of the prior; 0 for what does not change. `off`: from its mean.
    """
    left = np.concatenate([each.errors for each in errors])
    columns = np.concatenate([each.columns for each in errors])
    weight = np.ones_like(left)
    for some in POSE:
        # An error of usual size counts as one deviation, the horizons of a piece as one
        usual = np.mean(left[..., some] ** 2, axis=(0, 2), keepdims=True)
        weight[..., some] = 1.0 / np.maximum(usual * left.shape[1], 1e-12)
    free = spread > 0.0
    # In units of the prior
    scaled = columns[..., free].reshape(-1, int(free.sum())) * spread[free]
    inner = scaled.T @ (weight.reshape(-1, 1) * scaled) + ridge * np.eye(scaled.shape[1])
    pull = scaled.T @ (weight * left).ravel() - off[free] / spread[free]
    change = np.zeros(len(spread))
    change[free] = spread[free] * np.linalg.solve(inner, pull)
    return change


def score_forecasts(parts: Sequence[Array]) -> float:
    """Return the geometric mean of position and attitude errors at the horizon. [m, rad]"""
    left = np.concatenate(parts)[:, HORIZONS.index(FAR)]
    squares = [np.nanmean(np.sum(left[:, some] ** 2, axis=-1)) for some in POSE]
    return math.exp(0.5 * float(np.mean(np.log(np.maximum(squares, 1e-300)))))
