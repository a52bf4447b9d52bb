"""
Refit a law and the tolerances by replay: by the forecasts of the flights that it was found on.

The regression sees the force in each moment; a forecast sums it up over seconds, as whoever flies
the model does. Weights, numbers and tolerances are moved by Gauss-Newton steps on the errors of
these forecasts. A step counts only if what training flights teach makes the forecasts of the
confirming ones better, and vice versa.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_discovery.conclusion import FAR
from lta_discovery.fit.bounds import parameter_bounds
from lta_discovery.fit.evidence import Prior
from lta_discovery.forecast.prediction_errors import HORIZONS
from lta_discovery.laws.forecast import LawForecaster, Prepare
from lta_discovery.parallel import map_parallel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUNDS: Final = 3  # most Gauss-Newton steps
BETTER: Final = 0.995  # of the score; a step has to be better than this
PARTS: Final = (1.0, 0.5)  # of a step, tried in turn
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

    errors: Array  # measured minus predicted, 0 where unknown, shape (S, H, 6)
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
            teach, test = slice(0, self._count), slice(self._count, None)
            for part in PARTS:
                crossed = score_forecasts(
                    [
                        left
                        for learn, check in ((test, teach), (teach, test))
                        for left in self._try_step(model, law, errors[learn], part, check)
                    ]
                )
                if crossed < BETTER * best:
                    break
            else:
                break
            moved = self._step(model, law, errors, part)
            now = self.score(model.prepare(moved.weights), moved.shared)
            if now >= best:
                break
            law, best = moved, now
        return law

    def _forecast(
        self, prepare: Prepare | None, at: Array, makers: Sequence[LawForecaster]
    ) -> list[Array]:
        """Return the residuals of the pose, NaN where unknown, of each flight, (S, H, 6)."""
        return map_parallel(lambda each: each.compute_pose_residuals(prepare, at), makers)

    def _try_step(
        self, model: LawModel, law: FittedLaw, errors: Sequence[ForecastErrors], part: float,
        check: slice,
    ) -> list[Array]:  # fmt: skip
        """Return the residuals of some flights after a step that other flights teach."""
        moved = self._step(model, law, errors, part)
        return self._forecast(model.prepare(moved.weights), moved.shared, self._makers[check])

    def _step(
        self, model: LawModel, law: FittedLaw, errors: Sequence[ForecastErrors], part: float
    ) -> FittedLaw:
        """Return the law after part of a step."""
        left = np.concatenate([each.errors for each in errors])
        columns = np.concatenate([each.columns for each in errors])
        weight = np.ones_like(left)
        for some in POSE:
            # An error of usual size counts as one deviation, the horizons of a piece as one
            usual = np.mean(left[..., some] ** 2, axis=(0, 2), keepdims=True)
            weight[..., some] = 1.0 / np.maximum(usual * left.shape[1], 1e-12)
        spread = np.concatenate([model.spread, self._spread])
        free = spread > 0.0
        # In units of the prior
        scaled = columns[..., free].reshape(-1, int(free.sum())) * spread[free]
        off = np.concatenate([law.weights - model.start, np.zeros(len(law.shared))])
        inner = scaled.T @ (weight.reshape(-1, 1) * scaled) + np.eye(scaled.shape[1])
        pull = scaled.T @ (weight * left).ravel() - (off[free] / spread[free])
        change = np.zeros(len(spread))
        change[free] = part * spread[free] * np.linalg.solve(inner, pull)
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
            left, columns, pushed = maker.linearize_pose(prepare, law.shared)
            finite = np.isfinite(left)
            with_law = np.einsum('shck,skj->shcj', pushed, basis[-len(left) :])
            every = np.concatenate([with_law, columns], axis=-1)
            return ForecastErrors(np.where(finite, left, 0.0), every * finite[..., None])

        return map_parallel(linearize_flight, list(zip(self._makers, bases, strict=True)))


def score_forecasts(parts: Sequence[Array]) -> float:
    """Return the geometric mean of position and attitude errors at the horizon. [m, rad]"""
    left = np.concatenate(parts)[:, HORIZONS.index(FAR)]
    squares = [np.nanmean(np.sum(left[:, some] ** 2, axis=-1)) for some in POSE]
    return math.exp(0.5 * float(np.mean(np.log(np.maximum(squares, 1e-300)))))
