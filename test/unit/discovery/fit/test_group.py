"""Flights together are one great Gaussian, whatever is eliminated on the way."""

from dataclasses import replace

from lta_discovery.fit.evidence import (
    build_prior,
    build_shared_prior,
    compute_posterior,
    FLOOR,
    per_flight_variance,
    PieceReducer,
    Prior,
    ReducedFlight,
    wrench_floor,
)
from lta_discovery.fit.flight_group import LinearizedGroup
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizedFlight, unchanged_vehicle_point
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]
NAMED = ('net_lift.force', 'linear_drag.surge')


@pytest.fixture(scope='module')
def halves(gtmab: Known, clean: FlightLinearizer) -> tuple[PieceReducer, PieceReducer]:
    """The pieces of one flight as two flights, one of which stands elsewhere."""
    nominal, knobs = gtmab
    whole = clean.linearize(unchanged_vehicle_point(nominal, knobs, clean.replay.cut))
    own = np.sqrt(per_flight_variance(knobs))

    def part(which: slice, values: np.ndarray) -> PieceReducer:
        point = replace(whole.point, values=values, random=whole.point.random[which])
        return PieceReducer(
            LinearizedFlight(
                whole.names, whole.grams[which], whole.rows[which], point, whole.residual
            )
        )

    return part(slice(0, 2), 0.3 * own), part(slice(2, None), np.zeros(len(own)))


def test_what_is_each_flights_own_is_eliminated_as_in_one_great_matrix(
    gtmab: Known, halves: tuple[PieceReducer, PieceReducer]
) -> None:
    knobs = gtmab[1]
    variance, prior = per_flight_variance(knobs), build_shared_prior(knobs, NAMED)
    group = LinearizedGroup(halves, np.zeros(len(variance)), variance)
    found = compute_posterior(group.reduce_flights(FLOOR), group.at, prior)
    size, own = len(variance), np.flatnonzero(variance)
    wide = np.zeros((size + 2 * len(own) + 1,) * 2)
    constant = 0.0
    for f, each in enumerate(halves):
        one = each.eliminate_unknowns(FLOOR)
        place = np.r_[0:size, size + f * len(own) + np.arange(len(own)), len(wide) - 1]
        spread = np.r_[0:size, own, size]
        wide[np.ix_(place, place)] += one.products[np.ix_(spread, spread)]
        constant += one.constant
    many = np.diag(np.concatenate([np.diag(prior.covariance), variance[own], variance[own]]))
    at = np.concatenate([group.at, 0.3 * np.sqrt(variance[own]), np.zeros(len(own))])
    expected = compute_posterior(ReducedFlight(wide, constant), at, Prior(np.zeros(len(at)), many))
    assert found.log_evidence == pytest.approx(expected.log_evidence, abs=1e-4)
    np.testing.assert_allclose(found.mean, expected.mean[:size], rtol=1e-5, atol=1e-10)
    covariance = expected.covariance[:size, :size]
    np.testing.assert_allclose(found.covariance, covariance, rtol=1e-5, atol=1e-12)
    one = group.flight_posterior(halves[0], halves[0].eliminate_unknowns(FLOOR), found)
    through = np.zeros((size, len(at)))
    through[:, :size] = np.eye(size)
    through[own, size + np.arange(len(own))] = 1.0
    np.testing.assert_allclose(one.mean, through @ expected.mean, rtol=1e-5, atol=1e-10)
    total = through @ expected.covariance @ through.T
    np.testing.assert_allclose(one.covariance, total, rtol=1e-4, atol=1e-12)
    moved = group.solve_flights(FLOOR, found.mean)
    np.testing.assert_allclose(moved[0].values, one.mean, rtol=1e-5, atol=1e-10)


def test_one_flight_alone_is_a_group_of_one(
    gtmab: Known, halves: tuple[PieceReducer, PieceReducer]
) -> None:
    knobs, single = gtmab[1], halves[1]
    point = single.linear.point
    whole = compute_posterior(
        single.eliminate_unknowns(FLOOR), point.values, build_prior(knobs, NAMED)
    )
    group = LinearizedGroup((single,), point.values, per_flight_variance(knobs))
    parted = compute_posterior(
        group.reduce_flights(FLOOR), group.at, build_shared_prior(knobs, NAMED)
    )
    assert parted.log_evidence == pytest.approx(whole.log_evidence, abs=1e-4)
    one = group.flight_posterior(single, single.eliminate_unknowns(FLOOR), parted)
    np.testing.assert_allclose(one.mean, whole.mean, rtol=1e-4, atol=1e-9)


def test_a_vehicle_ten_times_as_heavy_has_a_floor_ten_times_as_high(gtmab: Known) -> None:
    nominal = gtmab[0]
    heavy = replace(nominal, mass=10.0 * nominal.mass, inertia=5.0 * nominal.inertia)
    ratio = wrench_floor(heavy) / wrench_floor(nominal)
    np.testing.assert_allclose(ratio, [10.0] * 3 + [5.0] * 3)
    np.testing.assert_allclose(wrench_floor(nominal), FLOOR, rtol=0.02)


def test_a_group_is_aligned_if_its_flights_agree_on_the_shared_values(
    gtmab: Known, halves: tuple[PieceReducer, PieceReducer]
) -> None:
    """Values that are each flight's own may differ."""
    variance = per_flight_variance(gtmab[1])
    group = LinearizedGroup(halves, np.zeros(len(variance)), variance)
    assert group.is_aligned
    assert not LinearizedGroup(halves, np.zeros(len(variance)), np.zeros(len(variance))).is_aligned
    k = int(np.flatnonzero(variance == 0.0)[0])
    there = np.zeros(len(variance))
    there[k] = 1e-3
    assert not replace(group, at=there).is_aligned
    assert replace(group, at=1e-10 * there).is_aligned  # rounding is tolerated
    joined = LinearizedGroup(halves[:1], there, variance).combine_groups(
        LinearizedGroup(halves[1:], group.at, 2 * variance)
    )
    assert joined.pieces == halves
    assert joined.at is there
    assert joined.variance is variance


def test_a_flight_linearised_elsewhere_is_moved_to_the_shared_values_of_the_group(
    gtmab: Known, halves: tuple[PieceReducer, PieceReducer]
) -> None:
    """
    The linear model moves its residual, so evidence and posterior do not depend on the point.

    Narrowing keeps the columns of the knob on which they differ.
    """
    variance, linear = per_flight_variance(gtmab[1]), halves[1].linear
    k = int(np.flatnonzero((variance == 0.0) & (build_prior(gtmab[1]).free))[0])
    stands, at = np.zeros((2, len(variance)))
    stands[k], at[k] = np.array([0.3, -0.5]) * np.sqrt(build_prior(gtmab[1]).covariance[k, k])
    single = PieceReducer(replace(linear, point=replace(linear.point, values=stands)))
    moved, still = (LinearizedGroup((single,), where, variance) for where in (at, stands))
    prior = build_shared_prior(gtmab[1], NAMED)
    one, other = (
        compute_posterior(each.reduce_flights(FLOOR), each.at, prior) for each in (moved, still)
    )
    assert one.log_evidence == pytest.approx(other.log_evidence, abs=1e-4)
    np.testing.assert_allclose(one.mean, other.mean, rtol=1e-5, atol=1e-9)
    alone = compute_posterior(
        single.eliminate_unknowns(FLOOR), stands, build_prior(gtmab[1], NAMED)
    )
    assert other.log_evidence == pytest.approx(alone.log_evidence, abs=1e-4)
    narrow, kept = moved.select(np.zeros(len(at), dtype=bool))
    assert kept.tolist() == sorted([*np.flatnonzero(variance), k])
    index = np.append(kept, len(at))
    expected = moved.reduce_flights(FLOOR).products[np.ix_(index, index)]
    size = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(
        narrow.reduce_flights(FLOOR).products / size, expected / size, atol=1e-9
    )
    assert narrow.at.tolist() == at[kept].tolist()
    free = prior.free
    assert still.select(free)[1].tolist() == np.flatnonzero(free | (variance > 0.0)).tolist()
