"""Generic rivals are weighed in the currency of effects, and win where the library has nothing."""

from dataclasses import replace

from lta_discovery.fit.evidence import (
    fitted,
    FLOOR,
    own_variance,
    Pieces,
    Prior,
    shared,
    tolerances,
)
from lta_discovery.fit.fit import Fitter, Joint
from lta_discovery.flights.windows import KNOTS
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.outside.generic_terms import Group, groups, met, Scene
from lta_discovery.outside.rivals import Contest, Rivals
from lta_discovery.outside.standing import Columns, Standing
from lta_discovery.outside.verdict import standing, verdict_of
from lta_discovery.replay.linear import AXES, origin, unknowns
from lta_discovery.replay.linearise import Linearised
from lta_discovery.replay.tangent import WIDTH
import numpy as np
import pytest

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own
from ..unknown_physics import KINDS  # noqa: TID252 - `test` is Python's own

Known = tuple[Nominal, list[Knob]]


def _fitted(known: Known, flight: Linearised) -> Joint:
    nominal, knobs = known
    begin = origin(nominal, knobs, flight.replay.cut)
    fitter = Fitter(nominal, [flight], own_variance(knobs), FLOOR)
    return fitter.fit(shared(knobs), fitter.about(begin.values, [begin]), FLOOR)


@pytest.fixture(scope='module')
def quiet(gtmab: Known, clean: Linearised) -> tuple[Standing, list[Group]]:
    """A clean flight, fitted, and all groups on it."""
    found = _fitted(gtmab, clean)
    place = clean.replay.flight.position
    scene = Scene.around([place[np.isfinite(place).all(axis=1)]])
    known = list(groups(met(clean, found.group.linears[0].point), scene, FLOOR, KNOTS))
    return Standing.of(found, FLOOR), known


def _alone(stands: Standing, knobs: list[Knob]) -> Standing:
    """Return the same flight with nothing of its own: all in the prior, about its point."""
    at = stands.linears[0].point.values
    return replace(stands, at=at, variance=np.zeros(len(at)), prior=tolerances(knobs))


def test_without_groups_the_evidence_is_that_of_the_fit(
    quiet: tuple[Standing, list[Group]], gtmab: Known
) -> None:
    joint, known = quiet
    stands = _alone(joint, gtmab[1])
    linear = stands.linears[0]
    for deviations in (stands.deviations, 3.0 * FLOOR):
        expected = fitted(Pieces(linear).reduced(deviations), linear.point.values, stands.prior)
        for each in (stands, joint):
            there = Columns(each, [known]).beside(deviations, [])
            assert there.base == pytest.approx(expected.log_evidence, abs=1e-5)


def test_a_group_is_worth_what_its_columns_are_as_knobs(
    quiet: tuple[Standing, list[Group]], gtmab: Known
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
    covariance = np.zeros((total - unknowns(KNOTS) - 1 + size,) * 2)
    covariance[:-size, :-size], covariance[-size:, -size:] = stands.prior.covariance, wide
    prior = Prior(np.concatenate([stands.prior.mean, zeros]), covariance)
    at = np.concatenate([linear.point.values, zeros])
    expected = fitted(Pieces(wider).reduced(stands.deviations), at, prior).log_evidence
    for each in (stands, joint):
        there = Columns(each, [known]).beside(each.deviations, [group.name])
        inner, right = there.inner[group.name], there.right[group.name]
        square = right @ np.linalg.solve(inner + np.linalg.inv(wide), right)
        logs = np.linalg.slogdet(np.eye(size) + wide @ inner)[1]
        assert there.base + 0.5 * square - 0.5 * logs == pytest.approx(expected, abs=1e-5)


def test_on_a_clean_flight_no_group_wins(quiet: tuple[Standing, list[Group]]) -> None:
    stands, known = quiet
    gains = Contest(Columns(stands, [known])).gains()
    assert len(gains) == len(known)
    assert max(one.gain for one in gains.values()) < 3.0


@pytest.mark.long
def test_wash_over_a_fin_is_found_and_described(gtmab: Known) -> None:
    make, _, strong = KINDS['swirl']
    flights = [
        prepared(flown({}, seed, 32.0, make(strong, np.random.default_rng(4)), 1.9), gtmab[1])
        for seed in (11, 12)
    ]
    stands = [Standing.of(_fitted(gtmab, flight), FLOOR) for flight in flights]
    found = Rivals([[flight] for flight in flights]).found(stands)
    assert found[0].name == 'yaw by thrust x speed'
    assert found[0].term == 'surge thrust x surge speed'
    assert found[0].share > 0.8
    assert standing(found)[0] == found[0]
    assert verdict_of((), (), found) == 'unexplained'
