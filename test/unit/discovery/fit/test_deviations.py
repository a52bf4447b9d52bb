"""How much force flights leave unexplained is found along the slope of the evidence."""

from lta_discovery.fit import deviations
from lta_discovery.fit.deviations import compute_newton_step, fit_deviations, maximize_evidence
from lta_discovery.fit.evidence import (
    build_shared_prior,
    compute_posterior,
    FLOOR,
    log_prior,
    per_flight_variance,
    PieceReducer,
    Prior,
)
from lta_discovery.fit.evidence_gradient import compute_evidence_gradient, EvidenceGradient
from lta_discovery.fit.flight_group import LinearizedGroup
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
import numpy as np
from numpy.typing import NDArray
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]
Array = NDArray[np.float64]


@pytest.fixture(scope='module')
def begun(gtmab: Known, clean: FlightLinearizer) -> tuple[LinearizedGroup, Prior]:
    """A flight about the vehicle file, and what is known of that."""
    nominal, knobs = gtmab
    at = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    return LinearizedGroup(
        (PieceReducer(clean.linearize(at)),), at.values, per_flight_variance(knobs)
    ), build_shared_prior(knobs)


def logged(group: LinearizedGroup, prior: Prior, deviations: Array) -> float:
    """Return the log evidence as it is defined."""
    found = compute_posterior(group.reduce_flights(deviations), group.at, prior)
    return found.log_evidence + log_prior(deviations)


@pytest.mark.parametrize('size', [0.3, 1.0, 6.0])
def test_the_slope_is_that_of_the_evidence(
    begun: tuple[LinearizedGroup, Prior], size: float
) -> None:
    group, prior = begun
    at = size * FLOOR
    seen = compute_evidence_gradient(group, prior, at, FLOOR)
    assert seen.value == pytest.approx(logged(group, prior, at), abs=1e-6)
    aside = 1e-3 * np.eye(len(FLOOR))
    ups, downs = (
        np.array([logged(group, prior, at * np.exp(way * each)) for each in aside])
        for way in (1.0, -1.0)
    )
    assert seen.slope == pytest.approx((ups - downs) / 2e-3, rel=1e-3, abs=1e-3)
    assert np.linalg.eigvalsh(seen.bend).min() > 0.0


def test_the_same_deviations_are_found_from_above_and_below(
    begun: tuple[LinearizedGroup, Prior],
) -> None:
    group, prior = begun
    low, high = (fit_deviations(group, prior, size * FLOOR, FLOOR, ()) for size in (0.2, 20.0))
    assert low[1] == pytest.approx(high[1], abs=0.1)
    assert low[0] == pytest.approx(high[0], rel=0.1)
    for axis in range(len(FLOOR)):  # nothing near is better
        for factor in (0.7, 1.4):
            near = low[0].copy()
            near[axis] *= factor
            assert logged(group, prior, near) < low[1]


def test_a_stride_ends_where_a_variance_does() -> None:
    """With one knot that is known exactly, the best variance is its square."""
    for spent in (0.5, 4.0):
        seen = EvidenceGradient(0.0, np.full(6, spent - 1.0), 2.0 * np.eye(6))
        assert compute_newton_step(seen) == pytest.approx(0.5 * np.log(spent))


def test_no_stride_is_made_where_there_is_no_evidence() -> None:
    def steep(_: Array) -> EvidenceGradient:
        return EvidenceGradient(-np.inf, np.ones(6), np.eye(6))

    at, value = maximize_evidence(steep, FLOOR, FLOOR)
    assert value == -np.inf
    assert at == pytest.approx(FLOOR)


def test_a_stride_changes_the_logarithm_of_a_deviation_by_at_most_two() -> None:
    for way in (1.0, -1.0):
        seen = EvidenceGradient(0.0, np.full(6, way * 1e9), np.eye(6))
        assert compute_newton_step(seen) == pytest.approx(way * 2.0)


def _hill(top: Array, bend: float = 4.0, steps: list[Array] | None = None) -> tuple[Array, float]:
    """
    Return where `maximize_evidence` ends on a parabola in the log deviations, in floors, and the
    value there.

    The parabola has a curvature of `bend` and its peak, of value 0, at `top` floors.
    """

    def value(deviations: Array) -> float:
        if steps is not None:
            steps.append(deviations / FLOOR)
        return float(-0.5 * bend * np.sum(np.log(deviations / FLOOR / top) ** 2))

    def steep(deviations: Array) -> EvidenceGradient:
        slope = -bend * np.log(deviations / FLOOR / top)
        return EvidenceGradient(value(deviations), slope, bend * np.eye(6))

    at, found = maximize_evidence(steep, FLOOR, FLOOR)
    assert found == pytest.approx(value(at))
    return at / FLOOR, found


@pytest.mark.parametrize('factor', [0.2, 0.9, 1.1, 5.0])
def test_the_peak_is_found_within_a_twentieth_of_a_nat(factor: float) -> None:
    top = factor ** np.array([1.0, 0.5, 0.0, 1.0, -0.2, 0.3])
    at, value = _hill(top)
    assert value > -0.05
    np.testing.assert_allclose(np.log(at), np.log(top), atol=0.15)


def test_deviations_stay_between_a_twentieth_of_a_floor_and_a_thousand_floors() -> None:
    low, _ = _hill(np.full(6, 1e-4))
    np.testing.assert_allclose(low, 0.05)
    high, _ = _hill(np.full(6, 1e6))
    np.testing.assert_allclose(high, 1e3)


def test_a_stride_is_made_only_if_the_slope_promises_0_01_nats() -> None:
    """With a curvature of 4, a stride to a peak that is 0.05 away promises 4 * 0.05^2 = 0.01."""
    for off, made in ((0.04, False), (0.06, True)):
        steps: list[Array] = []
        _hill(np.exp(np.r_[off, np.zeros(5)]), 4.0, steps)
        assert (np.ptp([step[0] for step in steps]) > 0.0) == made


def test_a_stride_that_never_helps_is_given_up_after_four_lengths() -> None:
    """
    The whole stride, 1/2, 1/4 and 1/8 of it are tried, and then the start is returned.

    With a slope of 1.5 and a curvature of 1 the whole stride is ln(1 + 2 * 1.5) / 2.
    """
    seen: list[float] = []

    def value(deviations: Array) -> float:
        seen.append(float(np.log(deviations[0] / FLOOR[0])))
        return 0.0 if len(seen) == 1 else -1.0

    slope = np.r_[1.5, np.zeros(5)]
    at, found = maximize_evidence(
        lambda at: EvidenceGradient(value(at), slope, np.eye(6)), FLOOR, FLOOR
    )
    whole = 0.5 * np.log(4.0)
    np.testing.assert_allclose(seen, [0.0, whole, whole / 2, whole / 4, whole / 8], atol=1e-12)
    assert found == 0.0
    np.testing.assert_allclose(at, FLOOR)


@pytest.mark.parametrize(
    ('kept', 'places'),
    [
        # The gain is what the slope promises: strides double, up to a thousand floors.
        (1.0, [0, 1, 3, 7, 15, np.log(1e3) / (0.5 * np.log(2.0))]),
        (0.7, [*range(13)]),  # less than 3/4 of that: twelve strides of one length
    ],
)
def test_strides_double_while_the_gain_is_what_the_slope_promises(
    kept: float, places: list[float]
) -> None:
    """With a slope of 1/2 and a curvature of 1 the first stride is ln(1 + 2 * 1/2) / 2."""
    seen: list[float] = []

    def value(deviations: Array) -> float:
        seen.append(float(np.log(deviations[0] / FLOOR[0])))
        return kept * 0.5 * seen[-1]

    slope = np.r_[0.5, np.zeros(5)]
    at, found = maximize_evidence(
        lambda at: EvidenceGradient(value(at), slope, np.eye(6)), FLOOR, FLOOR
    )
    np.testing.assert_allclose(seen, 0.5 * np.log(2.0) * np.array(places), atol=1e-9)
    assert found == pytest.approx(kept * 0.5 * np.log(at[0] / FLOOR[0]))


def test_a_start_from_small_deviations_is_tried_as_well(
    begun: tuple[LinearizedGroup, Prior], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It has no deviation above 2.5 floors, and is left out if it equals the first start."""
    group, prior = begun
    starts: list[Array] = []

    def climbed(steep: object, start: Array, floor: Array, worth: float) -> tuple[Array, float]:
        starts.append(start / floor)
        return start, float(-start[0])

    monkeypatch.setattr(deviations, 'maximize_evidence', climbed)
    wide = FLOOR * np.array([9.0, 1.0, 2.0, 3.0, 2.5, 2.6])
    found, _ = fit_deviations(group, prior, wide, FLOOR)
    np.testing.assert_allclose(
        starts, [[9.0, 1.0, 2.0, 3.0, 2.5, 2.6], [2.5, 1.0, 2.0, 2.5, 2.5, 2.5]]
    )
    np.testing.assert_allclose(found, FLOOR * starts[1])  # the better of the two
    starts.clear()
    fit_deviations(group, prior, 2.4 * FLOOR, FLOOR)
    assert len(starts) == 1
