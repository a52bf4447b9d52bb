"""Refits of a law whose forecasts are linear in its weight and in a tolerance, by hand."""

from types import SimpleNamespace
from typing import Any, cast

from lta_config.schema.vehicle_law import HiddenState, LawFactor
from lta_discovery.fit.evidence import Prior
from lta_discovery.forecast.prediction_errors import HORIZONS
from lta_discovery.laws.dictionary import Column, move_number
from lta_discovery.laws.forecast import DIVERGED, LawForecaster
from lta_discovery.laws.forecast_refit import ForecastRefit, LawModel, score_forecasts
from lta_discovery.laws.law_model import (
    build_law,
    build_law_model,
    list_own_numbers,
    Numbers,
)
from lta_discovery.laws.proposal import rank_laws
from lta_discovery.laws.selection import LawFit
from lta_model.law_arrays import evaluate_factor
import numpy as np
from numpy.typing import NDArray
import pytest

from ..synthetic_law import KNOTS, make_law_data, PIECES  # noqa: TID252 - `test` is Python's own

Array = NDArray[np.float64]


class LinearForecaster:
    """Forecasts of one flight: pose = columns @ (weight, tolerance) + noise."""

    def __init__(self, truth: tuple[float, float], seed: int) -> None:
        rng = np.random.default_rng(seed)
        self.columns = rng.normal(size=(PIECES, len(HORIZONS), 6, 2))
        self.pose = self.columns @ np.array(truth)
        self.pose += 0.01 * rng.normal(size=self.pose.shape)
        # Once not measured
        self.pose[0, 0, 0] = np.nan
        self.flight = SimpleNamespace(knobs=[])

    def compute_pose_residuals(self, prepare: Any, at: Array) -> Array:
        """Return what is left with a weight, which stands for the law, and a tolerance."""
        out: Array = self.pose - self.columns @ np.array([prepare, at[0]])
        return out

    def linearize_pose(
        self, prepare: Any, at: Array, free: NDArray[np.bool_]
    ) -> tuple[Array, Array, Array]:
        """Return the residuals, and their changes by the tolerance and by the wrench."""
        left = self.compute_pose_residuals(prepare, at)
        return left, self.columns[..., 1:] * free, self.columns[..., :1]


def refit(truths: list[tuple[float, float]], tolerance: float = 1.0) -> tuple[Array, Array]:
    """Return weight and tolerance refitted from (1, 0), where each flight has its truth."""
    makers = [LinearForecaster(truth, seed) for seed, truth in enumerate(truths)]
    prior = Prior(np.zeros(1), np.array([[tolerance**2]]))
    one = np.ones((PIECES, 1, 1))
    model = LawModel(
        np.array([1.0]), np.array([1.0]), lambda weights: cast('Any', weights[0]),
        lambda _weights: [one for _ in makers],
    )  # fmt: skip
    tool = ForecastRefit(cast('list[LawForecaster]', makers), 1, prior, np.zeros(1, dtype=bool))
    found = tool.fit(model, np.zeros(1))
    return found.weights, found.shared


def test_weight_and_tolerance_are_refitted() -> None:
    """Two flights of one vehicle agree about both."""
    weights, shared = refit([(1.4, -0.2), (1.4, -0.2)])
    assert weights == pytest.approx([1.4], abs=0.02)
    assert shared == pytest.approx([-0.2], abs=0.02)


def test_what_one_flight_teaches_must_help_the_other() -> None:
    """Each flight wants another change: nothing is changed."""
    weights, shared = refit([(1.4, -0.2), (0.6, 0.2)])
    assert weights.tolist() == [1.0]
    assert shared.tolist() == [0.0]


def test_a_held_parameter_stays() -> None:
    """A tolerance of 0 is not fitted, the weight is."""
    weights, shared = refit([(1.4, -0.2), (1.4, -0.2)], tolerance=0.0)
    assert weights == pytest.approx([1.4], abs=0.1)
    assert shared.tolist() == [0.0]


def test_a_law_is_refitted_alone() -> None:
    """With the shared parameters held, the weight takes what it can."""
    makers = [LinearForecaster((1.4, -0.2), seed) for seed in range(2)]
    one = np.ones((PIECES, 1, 1))
    model = LawModel(
        np.array([1.0]), np.array([1.0]), lambda weights: cast('Any', weights[0]),
        lambda _weights: [one for _ in makers],
    )  # fmt: skip
    prior = Prior(np.zeros(1), np.eye(1))
    tool = ForecastRefit(cast('list[LawForecaster]', makers), 1, prior, np.zeros(1, dtype=bool))
    alone = tool.hold_shared().fit(model, np.array([-0.15]))
    assert alone.weights == pytest.approx([1.4], abs=0.05)
    assert alone.shared.tolist() == [-0.15]
    # The first tool still fits both
    assert tool.fit(model, np.zeros(1)).shared == pytest.approx([-0.2], abs=0.02)


class TermForecaster:
    """Forecasts of one flight: pose = columns @ (weights, tolerances) + noise."""

    def __init__(self, truth: list[float], tolerances: int, seed: int, noise: float) -> None:
        rng = np.random.default_rng(seed)
        self.count = len(truth)
        shape = (PIECES, len(HORIZONS), 6)
        self.columns = rng.normal(size=(*shape, self.count + tolerances))
        self.pose = self.columns[..., : self.count] @ np.array(truth)
        self.pose += noise * rng.normal(size=shape)
        self.flight = SimpleNamespace(knobs=[])

    def compute_pose_residuals(self, prepare: Any, at: Array) -> Array:
        """Return what is left with weights, which stand for the law, and tolerances."""
        left = self.pose - self.columns @ np.concatenate([prepare, at])
        return np.where(np.isfinite(left), left, DIVERGED)

    def linearize_pose(
        self, prepare: Any, at: Array, free: NDArray[np.bool_]
    ) -> tuple[Array, Array, Array]:
        """Return the residuals, and their changes by the tolerances and by the wrench."""
        left = self.compute_pose_residuals(prepare, at)
        return left, self.columns[..., self.count :] * free, self.columns[..., : self.count]


def build_terms(
    truth: list[float], start: list[float], tolerances: int, noise: float
) -> tuple[ForecastRefit, LawModel]:
    """Return the refit of terms on two flights, and their law; each knot has one term."""
    makers = [TermForecaster(truth, tolerances, seed, noise) for seed in range(2)]
    own = np.broadcast_to(np.eye(len(truth)), (PIECES, len(truth), len(truth)))
    model = LawModel(
        np.array(start), np.ones(len(start)), lambda weights: cast('Any', weights),
        lambda _weights: [own for _ in makers],
    )  # fmt: skip
    prior = Prior(np.zeros(tolerances), np.eye(tolerances))
    held = np.zeros(tolerances, dtype=bool)
    return ForecastRefit(cast('list[LawForecaster]', makers), 1, prior, held), model


def test_terms_that_forecast_nothing_are_left_out_first() -> None:
    """One of three terms moves nothing, and one little; each set lacks one term of the last."""
    tool, model = build_terms([0.0, 2.0, 0.3], [0.2, 1.5, 0.5], 1, 0.05)
    sets = tool.rank_terms(model, np.zeros(1), 3)
    assert [some for _, some in sets] == [[0, 1, 2], [1, 2], [1]]
    scores = [score for score, _ in sets]
    assert scores[1] < 1.01 * scores[0]
    # Without the third: 0.3 instead of 0.05 is left
    assert scores[2] > 3.0 * scores[1]
    chosen = cast('Any', ['useless', 'large', 'small'])
    assert rank_laws(tool, chosen, model, np.zeros(1)) == [['large', 'small'], ['large']]


def test_many_tolerances_do_not_keep_a_weight_from_its_value() -> None:
    """With 150 tolerances and 180 readings a side, only a step drawn to 0 helps to forecast."""
    tool, model = build_terms([1.5], [1.0], 150, 1.0)
    before = tool.score(model.prepare(model.start), np.zeros(150))
    fitted = tool.fit(model, np.zeros(150))
    assert abs(fitted.weights[0] - 1.5) < 0.3
    assert tool.score(model.prepare(fitted.weights), fitted.shared) < before
    # A whole step fits the noise of one flight, and makes the other's forecasts worse
    assert np.abs(fitted.shared).max() < 0.2


def test_a_forecast_that_diverges_stops_no_step() -> None:
    """Its changes are not numbers; the other forecasts show the weight."""
    tool, model = build_terms([1.4], [1.0], 1, 0.01)
    for maker in cast('list[TermForecaster]', tool._makers):
        maker.columns[0, -1] = np.nan
    assert tool.fit(model, np.zeros(1)).weights == pytest.approx([1.4], abs=0.02)


def test_the_score_is_a_geometric_mean() -> None:
    """Of the distance and the angle after 3 s, over what was measured."""
    left = np.full((2, len(HORIZONS), 6), 9.0)
    left[:, HORIZONS.index(3.0), :3] = 0.1
    left[:, HORIZONS.index(3.0), 3:] = 0.4
    left[1] = np.nan
    assert score_forecasts([left]) == pytest.approx(0.2 * np.sqrt(3.0))


def test_weights_and_numbers_change_a_law() -> None:
    """The derivative by a number is that of the wrench; terms share a hidden state."""
    data = make_law_data(lambda seen: {})
    state = HiddenState(drive=[LawFactor(quantity='u')], time_constant=1.0)
    decay = LawFactor(quantity='height', form='decay', scale=0.4)
    chosen = [
        (Column((decay,), 0), 8),
        (Column((LawFactor(quantity='hidden'),), 2, state), 5),
        (Column((LawFactor(quantity='hidden'), LawFactor(quantity='r')), 2, state), 0),
    ]
    terms = [(data.knots(column), axis) for column, axis in chosen]
    fit = LawFit(data, 'all', data.joint.deviations, terms)
    model = build_law_model(data, chosen, fit)
    # Three weights, the height of the decay, the time constant
    assert model.start[3:].tolist() == [0.0, 0.0]
    weights = np.array([0.02, 0.003, 0.1, 0.0, 0.0])
    slopes = model.differentiate(weights)
    assert [each.shape for each in slopes] == [(PIECES, 6 * KNOTS, 5)] * 2
    numbers = Numbers(chosen, list_own_numbers(chosen))
    columns = numbers.move(data, np.array([0.1, -0.1]))
    assert columns[0][0].factors[0].scale == pytest.approx(0.4 * np.exp(0.1), rel=1e-3)
    lags = [column.hidden.time_constant for column, _ in columns if column.hidden is not None]
    assert lags == pytest.approx([np.exp(-0.1)] * 2, rel=1e-3)

    def push(those: list[tuple[Column, int]]) -> Array:
        parts = [data.body_knots(column, axis) for column, axis in those]
        return np.einsum('jsk,j->sk', np.stack(parts), weights[:3])

    change = push(list(columns)) - push(chosen)
    linear = np.concatenate(slopes)[..., 3:] @ np.array([0.1, -0.1])
    assert np.abs(linear - change).max() < 0.1 * np.abs(change).max()
    # The interval contains the weight of the regression
    refitted = fit.weights + 5.0 * fit.deviation
    law = build_law(data, columns, fit, 'a test', refitted)
    for term, first in zip(law.terms, fit.weights, strict=True):
        low, high = term.interval or (0.0, 0.0)
        assert low <= first <= term.coefficient <= high


def test_a_phase_adds_and_a_scale_multiplies() -> None:
    """A wave over the height stays where it is at the mean height, as its length changes."""
    spreads = make_law_data(lambda seen: {}).spreads
    mean = spreads['height'].mean
    column = Column((LawFactor(quantity='height', form='sin', scale=2.0, phase=0.5),), 0)
    shifted = move_number(column, (0, 'phase'), 0.2, spreads).factors[0]
    assert (shifted.scale, shifted.phase) == (2.0, pytest.approx(0.7))
    longer = move_number(column, (0, 'scale'), 0.2, spreads).factors[0]
    assert longer.scale == pytest.approx(2.0 * np.exp(0.2), rel=1e-3)
    at_mean = [evaluate_factor(one, np.array([mean]))[0] for one in (column.factors[0], longer)]
    assert at_mean[0] == pytest.approx(at_mean[1], abs=2e-3)
