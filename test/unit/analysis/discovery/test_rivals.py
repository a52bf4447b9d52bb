"""Generic rivals are weighed in the currency of effects, and win where the library has nothing."""

from dataclasses import replace

from lta_analysis.discovery.evidence import fitted, FLOOR, Pieces, Prior, tolerances
from lta_analysis.discovery.fit import Fit, fit
from lta_analysis.discovery.generic_terms import Group, groups, met, Scene
from lta_analysis.discovery.knobs import Knob
from lta_analysis.discovery.linear import AXES, KNOTS, origin, RANDOM
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.nominal import Nominal
from lta_analysis.discovery.rivals import Contest, displaced, Rivals
from lta_analysis.discovery.standing import Columns, Standing
from lta_analysis.discovery.tangent import WIDTH
from lta_analysis.discovery.verdict import standing, verdict_of
import numpy as np
import pytest

from .hidden_flight import flown, prepared
from .outside import KINDS

Known = tuple[Nominal, list[Knob]]


def _fitted(known: Known, flight: Linearised) -> Fit:
    nominal, knobs = known
    begin = origin(nominal, knobs, len(flight.replay.first))
    return fit(flight, nominal, tolerances(knobs), begin)


@pytest.fixture(scope='module')
def quiet(gtmab: Known, clean: Linearised) -> tuple[Standing, list[Group]]:
    """A clean flight, fitted, and all groups on it."""
    found = _fitted(gtmab, clean)
    place = clean.replay.flight.position
    scene = Scene.around([place[np.isfinite(place).all(axis=1)]])
    known = list(groups(met(clean, found.linear.point), scene, FLOOR))
    return Standing.of(found, tolerances(gtmab[1])), known


def test_without_groups_the_evidence_is_that_of_the_fit(
    quiet: tuple[Standing, list[Group]],
) -> None:
    stands, known = quiet
    linear = stands.linears[0]
    for deviations in (stands.deviations, 3.0 * FLOOR):
        there = Columns(stands, [known]).beside(deviations, [])
        expected = fitted(Pieces(linear).reduced(deviations), linear.point.values, stands.prior)
        assert there.base == pytest.approx(expected.log_evidence, abs=1e-6)


def test_a_group_is_worth_what_its_columns_are_as_knobs(
    quiet: tuple[Standing, list[Group]],
) -> None:
    stands, known = quiet
    linear, group = stands.linears[0], known[5]
    size = len(group.terms)
    weights = group.values.reshape(len(group.values), size, AXES * KNOTS)
    latent = linear.grams[:, :, WIDTH : WIDTH + AXES * KNOTS]
    more = np.einsum('snk,sjk->snj', latent, weights)
    own = np.einsum('snk,snj->skj', weights.transpose(0, 2, 1), more[:, WIDTH : WIDTH + 54])
    grams = np.block([[linear.grams, more], [more.transpose(0, 2, 1), own]])
    total = linear.grams.shape[1]
    order = np.r_[0 : total - 1, total : total + size, total - 1]
    wider = replace(linear, grams=grams[:, order[:, None], order])
    zeros, wide = np.zeros(size), (10.0**2 / size) * np.eye(size)
    covariance = np.zeros((total - RANDOM - 1 + size,) * 2)
    covariance[:-size, :-size], covariance[-size:, -size:] = stands.prior.covariance, wide
    prior = Prior(np.concatenate([stands.prior.mean, zeros]), covariance)
    at = np.concatenate([linear.point.values, zeros])
    expected = fitted(Pieces(wider).reduced(stands.deviations), at, prior)
    there = Columns(stands, [known]).beside(stands.deviations, [group.name])
    inner, right = there.inner[group.name], there.right[group.name]
    square = right @ np.linalg.solve(inner + np.linalg.inv(wide), right)
    logs = np.linalg.slogdet(np.eye(size) + wide @ inner)[1]
    assert there.base + 0.5 * square - 0.5 * logs == pytest.approx(expected.log_evidence, abs=1e-6)


def test_a_flights_own_errors_are_as_free_as_in_its_prior(
    quiet: tuple[Standing, list[Group]], gtmab: Known
) -> None:
    stands, known = quiet
    own = np.array([k.tolerance**2 if k.per_flight else 0.0 for k in gtmab[1]] + [0.0] * 4)
    shared = Prior(stands.prior.mean, stands.prior.covariance - np.diag(own))
    at = np.where(own > 0.0, 0.0, stands.at)
    apart = replace(stands, at=at, variance=own, prior=shared)
    name = known[3].name
    together, split = (
        Columns(each, [known]).beside(stands.deviations, [name]) for each in (stands, apart)
    )
    assert split.base == pytest.approx(together.base, abs=1e-5)
    np.testing.assert_allclose(split.inner[name], together.inner[name], rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(split.right[name], together.right[name], rtol=1e-4, atol=1e-4)


def test_on_a_clean_flight_no_group_wins(quiet: tuple[Standing, list[Group]]) -> None:
    stands, known = quiet
    gains = Contest(stands, [known]).gains()
    assert len(gains) == len(known)
    assert max(one.gain for one in gains.values()) < 3.0


def test_air_in_layers_is_found_and_described(gtmab: Known) -> None:
    make, _, strong = KINDS['layers']
    flights = [
        prepared(flown({}, seed, 32.0, make(strong, np.random.default_rng(4))), gtmab[1])
        for seed in (11, 12)
    ]
    prior = tolerances(gtmab[1])
    fits = [_fitted(gtmab, flight) for flight in flights]
    found = Rivals([[flight] for flight in flights]).found([Standing.of(f, prior) for f in fits])
    assert found[0].axis == 'heave'
    assert found[0].name in ('heave by height', 'heave by place')
    assert standing(found)
    assert verdict_of((), (), found) == 'unexplained'


def test_a_candidate_falls_to_a_better_rival_unless_it_has_more_to_say() -> None:
    assert displaced(100.0, {'field': 119.0}, {'field': 5.0}) == ''  # not clearly better
    assert displaced(100.0, {'field': 300.0}, {'field': 203.0}) == 'field'
    assert displaced(100.0, {'field': 300.0}, {'field': 290.0}) == ''  # two things at once
    assert displaced(100.0, {'a': 300.0, 'b': 200.0}, {'a': 290.0, 'b': 90.0}) == 'b'
