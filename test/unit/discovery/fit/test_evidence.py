"""Evidence on small matrices is the evidence of the dense Gaussian."""

from dataclasses import replace
from types import SimpleNamespace

from lta_discovery.fit.evidence import (
    build_prior,
    build_shared_prior,
    compute_posterior,
    FLOOR,
    knot_precision,
    log_prior,
    log_prior_slope,
    OWN,
    ParameterPosterior,
    per_flight_variance,
    PIECE_PRESSURE,
    PieceReducer,
    posterior_as_prior,
    Prior,
    STATE,
    unknowns_penalty,
)
from lta_discovery.flights.windows import KNOTS
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import (
    AXES,
    count_unknowns,
    LinearizationPoint,
    LinearizedFlight,
    unchanged_vehicle_point,
)
from lta_discovery.selection.candidate_scan import column_cosines, scan_candidates
import numpy as np
import pytest
from scipy.stats import multivariate_normal

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own

Known = tuple[NominalVehicle, list[FreeParameter]]
DEVIATIONS = 0.8 * FLOOR
RANDOM = count_unknowns(KNOTS)


@pytest.fixture(scope='module')
def linear(gtmab: Known, clean: FlightLinearizer) -> LinearizedFlight:
    """The clean flight about the vehicle file."""
    return clean.linearize(unchanged_vehicle_point(gtmab[0], gtmab[1], clean.replay.cut))


def test_the_evidence_is_that_of_the_dense_gaussian(gtmab: Known, clean: FlightLinearizer) -> None:
    nominal, knobs = gtmab
    point = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    columns, left = (part[:1, ::15] for part in clean.compute_whitened_columns(point))
    known = np.isfinite(left)
    table = np.where(known[..., None], columns, 0.0).reshape(-1, columns.shape[-1])[known.ravel()]
    y = left[known]
    full = np.column_stack([table, y])
    whole = LinearizedFlight(
        (*(knob.name for knob in knobs), *('own' for _ in OWN)),
        (full.T @ full)[None],
        np.array([len(y)]),
        replace(point, random=point.random[:1]),
        left,
    )
    knots = np.linalg.inv(knot_precision(KNOTS))
    prior = np.zeros((RANDOM, RANDOM))
    prior[np.diag_indices(12)] = STATE**2
    for axis in range(AXES):
        at = slice(12 + axis * KNOTS, 12 + (axis + 1) * KNOTS)
        prior[at, at] = knots * DEVIATIONS[axis] ** 2
    prior[-1, -1] = PIECE_PRESSURE**2
    own = build_prior(knobs)
    shared, single = table[:, RANDOM:], table[:, :RANDOM]
    covariance = np.eye(len(y)) + single @ prior @ single.T + shared @ own.covariance @ shared.T
    expected = multivariate_normal.logpdf(y, np.zeros(len(y)), covariance, allow_singular=False)
    found = compute_posterior(
        PieceReducer(whole).eliminate_unknowns(DEVIATIONS), point.values, own
    )
    assert found.log_evidence == pytest.approx(expected, abs=1e-4 * abs(expected))
    answer = own.covariance @ shared.T @ np.linalg.solve(covariance, y)
    np.testing.assert_allclose(found.mean, answer, rtol=1e-4, atol=1e-9)


def test_a_glance_is_the_difference_of_two_evidences(
    gtmab: Known, linear: LinearizedFlight
) -> None:
    knobs, reduced = gtmab[1], PieceReducer(linear).eliminate_unknowns(DEVIATIONS)
    at, without = linear.point.values, build_prior(gtmab[1])
    for seen in scan_candidates(reduced, at, without, knobs)[:8]:
        there = compute_posterior(reduced, at, build_prior(knobs, (seen.name,)))
        k = linear.names.index(seen.name)
        gain = there.log_evidence - compute_posterior(reduced, at, without).log_evidence
        assert seen.gain == pytest.approx(gain, abs=1e-3)
        assert seen.value == pytest.approx(there.mean[k], rel=1e-3)
        assert seen.deviation == pytest.approx(there.covariance[k, k] ** 0.5, rel=1e-3)


@pytest.mark.long
def test_linearised_at_the_truth_scores_are_those_of_noise(gtmab: Known) -> None:
    # Nuisances that may be anything, so that it does not matter which the truth has.
    nominal, knobs = gtmab
    known = build_prior(knobs)
    wide = Prior(known.mean, 100.0 * known.covariance)
    scores = []
    for seed in (21, 22, 23):
        flight = prepared(flown({}, seed, 45.0), knobs)
        about = flight.linearize(unchanged_vehicle_point(nominal, knobs, flight.replay.cut))
        first = PieceReducer(about)
        change = compute_posterior(
            first.eliminate_unknowns(0.2 * FLOOR), about.point.values, wide
        ).mean
        random = first.solve_unknowns(0.2 * FLOOR, change)
        # States and biases where they are most probable; the vehicle where the truth is.
        again = flight.linearize(replace(about.point, random=random))
        reduced = PieceReducer(again).eliminate_unknowns(0.2 * FLOOR)
        seen = scan_candidates(reduced, again.point.values, wide, knobs)
        free = {knob.name for knob in knobs if knob.tolerance == 0.0}
        scores += [one.score for one in seen if one.name in free]
    assert abs(np.mean(scores)) < 0.35
    assert 0.7 < np.std(scores) < 1.3
    assert np.abs(scores).max() < 4.0


def test_one_constant_force_has_many_names_and_drag_has_its_own(
    gtmab: Known, linear: LinearizedFlight
) -> None:
    names = ('net_lift.force', 'ballast.mass', 'payload.mass', 'quadratic_drag.surge')
    reduced, prior = PieceReducer(linear).eliminate_unknowns(DEVIATIONS), build_prior(gtmab[1])
    cosine = np.abs(column_cosines(reduced, prior, names, gtmab[1]))
    np.testing.assert_allclose(np.diag(cosine), 1.0)
    assert cosine[:3, :3].min() > 0.98
    assert cosine[3, :3].max() < 0.7


def test_a_latent_force_has_a_correlation_time_of_1_5_s() -> None:
    """Adjacent ones of nine knots over 6 s and 12 s are 0.5 and 1 correlation times apart."""
    for length, apart in ((6.0, 0.5), (12.0, 1.0)):
        covariance = np.linalg.inv(knot_precision(9, length))
        steps = np.abs(np.subtract.outer(np.arange(9), np.arange(9)))
        np.testing.assert_allclose(covariance, np.exp(-apart * steps), atol=1e-12)
    np.testing.assert_array_equal(knot_precision(9), knot_precision(9, 6.0))


KNOBS = [
    SimpleNamespace(name='a', tolerance=0.2, typical=3.0, per_flight=True),
    SimpleNamespace(name='b', tolerance=0.5, typical=0.0, per_flight=False),
    SimpleNamespace(name='c', tolerance=0.0, typical=2.0, per_flight=False),
]


def test_the_prior_adds_the_typical_size_of_named_knobs_to_the_tolerances() -> None:
    """
    Each flight has its own errors of sensors and its own values of knobs that are per flight.

    The errors are a pressure offset, 20 cm of air at 12 Pa/m, and 0.6 % of each specific force.
    """
    own = [2.4**2] + [0.006**2] * 3
    prior = build_prior(KNOBS, ('a', 'c'))
    np.testing.assert_allclose(prior.covariance, np.diag([9.04, 0.25, 4.0, *own]))
    assert not prior.mean.any()
    bare = build_prior(KNOBS)
    np.testing.assert_allclose(bare.covariance, np.diag([0.04, 0.25, 0.0, *own]))
    assert bare.free.tolist() == [True, True, False] + [True] * 4
    np.testing.assert_allclose(per_flight_variance(KNOBS), [0.04, 0.0, 0.0, *own])
    both = build_shared_prior(KNOBS, ('a',))
    np.testing.assert_allclose(both.covariance, np.diag([9.0, 0.25, 0.0, 0, 0, 0, 0]))


def test_the_posterior_of_some_flights_is_widened_to_be_the_prior_of_others() -> None:
    """The covariance is multiplied by 1.5 unless another factor is given."""
    before = ParameterPosterior(0.0, np.array([1.0, 2.0]), np.array([[4.0, 1.0], [1.0, 2.0]]))
    np.testing.assert_array_equal(posterior_as_prior(before).covariance, [[6.0, 1.5], [1.5, 3.0]])
    np.testing.assert_array_equal(
        posterior_as_prior(before, 2.0).covariance, [[8.0, 2.0], [2.0, 4.0]]
    )
    assert posterior_as_prior(before).mean is before.mean


def test_a_deviation_of_1_3_floors_is_the_likeliest() -> None:
    """Its logarithm has a normal prior with a standard deviation of 0.7."""
    usual = 1.3 * FLOOR
    assert log_prior(usual) == pytest.approx(0.0, abs=1e-12)
    off = usual * np.exp([0.7, -0.7, 1.4, 0.0, 0.0, 0.0])
    assert log_prior(off) == pytest.approx(-0.5 * (1.0 + 1.0 + 4.0))
    slope, bend = log_prior_slope(off)
    np.testing.assert_allclose(slope, np.array([-1.0, 1.0, -2.0, 0.0, 0.0, 0.0]) / 0.7, atol=1e-12)
    np.testing.assert_allclose(bend, np.eye(6) / 0.49)
    assert log_prior(2.0 * off, 2.0 * FLOOR) == pytest.approx(log_prior(off))


def test_strain_sums_the_squares_of_unknowns_in_standard_deviations() -> None:
    """They are 2 cm, 2 degrees, 8 cm/s, 0.08 rad/s, 5 cm of air and those of the latent wrench."""
    for k, size in ((0, 0.02), (2, 0.02), (3, np.radians(2.0)), (5, np.radians(2.0)), (6, 0.08),
                    (8, 0.08), (9, 0.08), (11, 0.08), (RANDOM - 1, 0.05 * 12.0)):  # fmt: skip
        random = np.zeros((2, RANDOM))
        random[1, k] = 3.0 * size
        assert unknowns_penalty(
            LinearizationPoint(None, None, random), DEVIATIONS
        ) == pytest.approx(9.0, rel=0.01)
    # A force that is equal at all knots of an axis strains by its square times the sum of all
    # elements of the knots' precision. That sum is 1 + 8 tanh(1 / 4), since the knots are half a
    # correlation time apart.
    random = np.zeros((2, RANDOM))
    random[0, 12:30] = np.repeat(2.0 * DEVIATIONS[:2], 9)
    expected = 2.0 * 4.0 * (1.0 + 8.0 * np.tanh(0.25))
    assert unknowns_penalty(LinearizationPoint(None, None, random), DEVIATIONS) == pytest.approx(
        expected
    )


def _displaced(linear: LinearizedFlight) -> PieceReducer:
    """Return the flight about a point at which the unknowns of its pieces are not 0."""
    rng = np.random.default_rng(2)
    scale = np.concatenate([STATE, np.repeat(DEVIATIONS, KNOTS), [PIECE_PRESSURE]])
    random = scale * rng.normal(size=linear.point.random.shape)
    return PieceReducer(replace(linear, point=replace(linear.point, random=random)))


def test_all_ways_to_reduce_a_flight_agree(gtmab: Known, linear: LinearizedFlight) -> None:
    pieces = _displaced(linear)
    whole, found = pieces.eliminate_unknowns(DEVIATIONS), pieces.solve_latent(DEVIATIONS)
    size = np.sqrt(np.diag(whole.products))
    size = np.outer(size, size) + 1e-300
    np.testing.assert_allclose(found.reduced.products / size, whole.products / size, atol=1e-7)
    assert found.reduced.constant == pytest.approx(whole.constant)
    kept = np.flatnonzero(build_prior(gtmab[1]).free)
    some = pieces.select(kept)
    index = np.append(kept, len(linear.names))
    np.testing.assert_allclose(
        some.eliminate_unknowns(DEVIATIONS).products, whole.products[np.ix_(index, index)]
    )
    assert some.linear.names == tuple(linear.names[k] for k in kept)
    np.testing.assert_array_equal(some.linear.point.values, linear.point.values[kept])


def test_unknowns_of_pieces_are_the_dense_least_squares_solution(linear: LinearizedFlight) -> None:
    """They minimise misfit plus prior, given knobs that differ from those of the point."""
    pieces = _displaced(linear)
    change = 1e-3 * np.random.default_rng(4).normal(size=len(linear.names))
    found = pieces.solve_unknowns(DEVIATIONS, change)
    knots = np.linalg.inv(np.exp(-0.5 * np.abs(np.subtract.outer(np.arange(9), np.arange(9)))))
    precision = np.zeros((RANDOM, RANDOM))
    precision[np.diag_indices(12)] = STATE**-2.0
    precision[12:66, 12:66] = np.kron(np.diag(DEVIATIONS**-2.0), knots)
    precision[66, 66] = PIECE_PRESSURE**-2.0
    for s, gram in enumerate(linear.grams):
        before = pieces.linear.point.random[s]
        # At the solution the gradient of misfit plus strain is 0.
        step = found[s] - before
        pull = gram[:RANDOM, -1] - gram[:RANDOM, :RANDOM] @ step
        pull -= gram[:RANDOM, RANDOM:-1] @ change
        slope = (pull - precision @ found[s]) / np.sqrt(
            np.diag(gram[:RANDOM, :RANDOM] + precision)
        )
        assert np.abs(slope).max() < 1e-6 * np.abs(pull).max()
