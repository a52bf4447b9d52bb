"""Generic rivals are weighed in the currency of effects, and win where the library has nothing."""

from dataclasses import replace

from lta_discovery.fit.evidence import (
    build_prior,
    build_shared_prior,
    compute_posterior,
    FLOOR,
    per_flight_variance,
    PieceReducer,
    Prior,
)
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.flights.windows import KNOTS
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import AXES, count_unknowns, unchanged_vehicle_point
from lta_discovery.replay.variational_equation import WIDTH
from lta_discovery.unmodeled.fit_baseline import FitBaseline, TermColumns
from lta_discovery.unmodeled.generic_terms import (
    compute_term_inputs,
    FlightBoundingBox,
    list_term_groups,
    TermGroup,
)
from lta_discovery.unmodeled.rivals import (
    _build_rival,
    GroupComparison,
    GroupGain,
    RivalSearch,
)
from lta_discovery.unmodeled.verdict import decide_verdict, select_confirmed_rivals
import numpy as np
import pytest

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own
from ..unknown_physics import KINDS  # noqa: TID252 - `test` is Python's own

Known = tuple[NominalVehicle, list[FreeParameter]]


def _fitted(known: Known, flight: FlightLinearizer) -> JointFit:
    nominal, knobs = known
    begin = unchanged_vehicle_point(nominal, knobs, flight.replay.cut)
    fitter = JointFitter(nominal, [flight], per_flight_variance(knobs), FLOOR)
    return fitter.fit(
        build_shared_prior(knobs), fitter.linearize_flights(begin.values, [begin]), FLOOR
    )


@pytest.fixture(scope='module')
def quiet(gtmab: Known, clean: FlightLinearizer) -> tuple[FitBaseline, list[TermGroup]]:
    """A clean flight, fitted, and all groups on it."""
    found = _fitted(gtmab, clean)
    place = clean.replay.flight.position
    scene = FlightBoundingBox.from_positions([place[np.isfinite(place).all(axis=1)]])
    known = list(
        list_term_groups(
            compute_term_inputs(clean, found.group.linears[0].point), scene, FLOOR, KNOTS
        )
    )
    return FitBaseline.from_joint(found, FLOOR), known


def _alone(stands: FitBaseline, knobs: list[FreeParameter]) -> FitBaseline:
    """Return the same flight with nothing of its own: all in the prior, about its point."""
    at = stands.linears[0].point.values
    return replace(stands, at=at, variance=np.zeros(len(at)), prior=build_prior(knobs))


def test_without_groups_the_evidence_is_that_of_the_fit(
    quiet: tuple[FitBaseline, list[TermGroup]], gtmab: Known
) -> None:
    joint, known = quiet
    stands = _alone(joint, gtmab[1])
    linear = stands.linears[0]
    for deviations in (stands.deviations, 3.0 * FLOOR):
        expected = compute_posterior(
            PieceReducer(linear).eliminate_unknowns(deviations), linear.point.values, stands.prior
        )
        for each in (stands, joint):
            there = TermColumns(each, [known]).reduce_groups(deviations, [])
            assert there.base == pytest.approx(expected.log_evidence, abs=1e-5)


def test_a_group_is_worth_what_its_columns_are_as_knobs(
    quiet: tuple[FitBaseline, list[TermGroup]], gtmab: Known
) -> None:
    joint, known = quiet
    stands, group = _alone(joint, gtmab[1]), known[5]
    linear = stands.linears[0]
    size = len(group.terms)
    weights = group.values.reshape(len(group.values), size, AXES * KNOTS)
    latent = linear.grams[:, :, WIDTH : WIDTH + AXES * KNOTS]
    more = np.einsum('snk,sjk->snj', latent, weights)
    own = np.einsum('sjk,ski->sji', weights, more[:, WIDTH : WIDTH + AXES * KNOTS])
    grams = np.block([[linear.grams, more], [more.transpose(0, 2, 1), own]])
    total = linear.grams.shape[1]
    order = np.r_[0 : total - 1, total : total + size, total - 1]
    wider = replace(linear, grams=grams[:, order[:, None], order])
    zeros, wide = np.zeros(size), (10.0**2 / size) * np.eye(size)
    covariance = np.zeros((total - count_unknowns(KNOTS) - 1 + size,) * 2)
    covariance[:-size, :-size], covariance[-size:, -size:] = stands.prior.covariance, wide
    prior = Prior(np.concatenate([stands.prior.mean, zeros]), covariance)
    at = np.concatenate([linear.point.values, zeros])
    expected = compute_posterior(
        PieceReducer(wider).eliminate_unknowns(stands.deviations), at, prior
    ).log_evidence
    for each in (stands, joint):
        there = TermColumns(each, [known]).reduce_groups(each.deviations, [group.name])
        inner, right = there.inner[group.name], there.right[group.name]
        square = right @ np.linalg.solve(inner + np.linalg.inv(wide), right)
        logs = np.linalg.slogdet(np.eye(size) + wide @ inner)[1]
        assert there.base + 0.5 * square - 0.5 * logs == pytest.approx(expected, abs=1e-5)


def test_on_a_clean_flight_no_group_wins(quiet: tuple[FitBaseline, list[TermGroup]]) -> None:
    stands, known = quiet
    gains = GroupComparison(TermColumns(stands, [known])).compute_group_gains()
    assert len(gains) == len(known)
    assert max(one.gain for one in gains.values()) < 3.0


@pytest.mark.long
def test_wash_over_a_fin_is_found_and_described(gtmab: Known) -> None:
    make, _, strong = KINDS['swirl']
    flights = [
        prepared(flown({}, seed, 32.0, make(strong, np.random.default_rng(4)), 1.9), gtmab[1])
        for seed in (11, 12)
    ]
    stands = [FitBaseline.from_joint(_fitted(gtmab, flight), FLOOR) for flight in flights]
    found = RivalSearch([[flight] for flight in flights]).rank_rivals(stands)
    assert found[0].name == 'yaw by thrust x speed'
    assert found[0].term == 'surge thrust x surge speed'
    assert found[0].share > 0.8
    assert select_confirmed_rivals(found)[0] == found[0]
    assert decide_verdict((), (), found) == 'unexplained'


def test_a_rival_of_flights_with_different_knots_has_the_size_of_all_knots() -> None:
    """Forces of 2 at 3 knots and of 4 at 9: the root mean square of 12 knots."""
    flights = []
    for knots, force in ((3, 2.0), (9, 4.0)):
        values = np.zeros((1, 1, AXES, knots))
        values[0, 0, 2] = force
        flights.append(TermGroup('heave by height', (2,), ('height',), values))
    taught = GroupGain(20.0, np.ones(1), np.eye(1), FLOOR)
    rival = _build_rival(flights, taught, (5.0, 6.0), FLOOR)
    assert rival.size == pytest.approx(np.sqrt((3 * 4.0 + 9 * 16.0) / 12))
    assert (rival.axis, rival.term) == ('heave', 'height')
