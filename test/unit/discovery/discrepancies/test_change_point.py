"""A change for good is as likely as an unknown more makes it, and found where it is."""

from dataclasses import replace
from types import SimpleNamespace

from lta_discovery.discrepancies import change_point
from lta_discovery.discrepancies.change_point import find_change_point
from lta_discovery.fit.evidence import build_prior, compute_posterior, Prior
from lta_discovery.fit.joint_fit import fit_flight, FlightFit
from lta_discovery.fit.robust_variance import reduce_each_piece
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]


@pytest.fixture(scope='module')
def quiet(gtmab: Known, clean: FlightLinearizer) -> FlightFit:
    """A flight in which nothing changes."""
    nominal, knobs = gtmab
    begin = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    return fit_flight(clean, nominal, build_prior(knobs), begin, rounds=1)


def _longer(this: FlightFit, times: int) -> FlightFit:
    """Return a flight as if it had been flown several times over."""
    linear = this.linear
    point = replace(linear.point, random=np.tile(linear.point.random, (times, 1)))
    long = replace(
        linear,
        grams=np.tile(linear.grams, (times, 1, 1)),
        rows=np.tile(linear.rows, times),
        point=point,
    )
    return replace(this, linear=long)


def _changed(
    this: FlightFit, knobs: list[FreeParameter], name: str, size: float, piece: int
) -> FlightFit:
    """Return a flight with a knob turned from a piece on, as linear as it is."""
    grams = this.linear.grams.copy()
    width = grams.shape[1] - len(this.linear.names) - 1
    k = width + [knob.name for knob in knobs].index(name)
    shift = np.eye(grams.shape[1])
    shift[k, -1] = size  # residual + size * column
    grams[piece:] = shift.T @ grams[piece:] @ shift
    return replace(this, linear=replace(this.linear, grams=grams))


def test_the_pieces_together_are_the_flight(quiet: FlightFit) -> None:
    whole = quiet.pieces.eliminate_unknowns(quiet.deviations).products
    assert reduce_each_piece(quiet.linear, quiet.deviations).sum(axis=0) == pytest.approx(
        whole, rel=1e-9, abs=1e-6
    )


@pytest.mark.parametrize('off', [0.0, 0.5])
def test_what_is_won_is_the_log_evidence_of_one_unknown_more(
    gtmab: Known, quiet: FlightFit, off: float
) -> None:
    """The flight is linearised about the vehicle file, and half of each tolerance from it."""
    knobs, name, piece = gtmab[1], 'net_lift.force', 5
    this = _changed(_longer(quiet, 2), knobs, name, 0.02, piece)
    values = this.linear.point.values + off * np.sqrt(np.diag(build_prior(knobs).covariance))
    this = replace(
        this, linear=replace(this.linear, point=replace(this.linear.point, values=values))
    )
    found = find_change_point(this, knobs, 1)
    assert found is not None
    assert (found.piece, found.knob) == (piece, name)
    each, k = (
        reduce_each_piece(this.linear, this.deviations),
        [knob.name for knob in knobs].index(name),
    )
    prior, at = build_prior(knobs), this.linear.point.values
    after = each[piece:].sum(axis=0)
    size = len(at)
    wider = np.zeros((size + 2, size + 2))
    old = np.r_[0:size, size + 1]
    wider[np.ix_(old, old)] = each.sum(axis=0)
    wider[size, old] = wider[old, size] = after[k]
    wider[size, size] = after[k, k]
    covariance = np.zeros((size + 1, size + 1))
    covariance[:size, :size] = prior.covariance
    covariance[size, size] = (3.0 * knobs[k].typical) ** 2
    with_it = compute_posterior(
        replace(quiet.reduced, products=wider),
        np.append(at, 0.0),
        Prior(np.append(prior.mean, 0.0), covariance),
    )
    without = compute_posterior(replace(quiet.reduced, products=each.sum(axis=0)), at, prior)
    won = with_it.log_evidence - without.log_evidence
    assert found.won == pytest.approx(won, rel=1e-6)
    assert with_it.mean[-1] == pytest.approx(0.02, rel=0.1)


def test_where_nothing_changes_nothing_is_found(gtmab: Known, quiet: FlightFit) -> None:
    assert find_change_point(quiet, gtmab[1], 1) is None
    assert find_change_point(_longer(quiet, 3), gtmab[1], 1) is None


INFORMATION = 10.0  # of each piece on each knob


def _found(
    monkeypatch: pytest.MonkeyPatch, pieces: int, changed: slice, pull: float
) -> change_point.ChangePoint | None:
    """Return the change found if some pieces pull at one knob, and harder at two fixed ones."""
    each = np.zeros((pieces, 4, 4))
    each[:, range(3), range(3)] = INFORMATION
    each[changed, 1, -1] = pull
    each[changed, 0, -1] = each[changed, 2, -1] = 3.0 * pull
    knobs = [
        SimpleNamespace(name='vehicle.mass', typical=1.0),  # cannot change in flight
        SimpleNamespace(name='rotor_fault.lost_1', typical=1.0),
        SimpleNamespace(name='net_lift.force', typical=0.0),  # no candidate: its typical size is 0
    ]
    held = Prior(np.zeros(3), np.zeros((3, 3)))
    monkeypatch.setattr(change_point, 'reduce_each_piece', lambda *_: each)
    monkeypatch.setattr(change_point, 'build_prior', lambda _: held)
    point = SimpleNamespace(values=np.zeros(3))
    return find_change_point(
        SimpleNamespace(linear=SimpleNamespace(point=point), deviations=None), knobs, 1
    )


def _won(count: int, pull: float) -> float:
    """Return the log Bayes factor of a change of prior variance 9 that some pieces pull at."""
    information = count * INFORMATION
    square = 0.5 * (count * pull) ** 2 / (information + 1.0 / 9.0)
    return float(square - 0.5 * np.log(1.0 + 9.0 * information))


@pytest.mark.parametrize(('pieces', 'first'), [(8, 4), (10, 8)])
def test_a_change_begins_with_the_first_piece_that_pulls(
    monkeypatch: pytest.MonkeyPatch, pieces: int, first: int
) -> None:
    found = _found(monkeypatch, pieces, slice(first, None), 14.0)
    assert found is not None
    assert (found.piece, found.knob) == (first, 'rotor_fault.lost_1')
    assert found.won == pytest.approx(_won(pieces - first, 14.0))


def test_a_change_may_come_after_only_two_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    found = _found(monkeypatch, 10, slice(2, None), 14.0)
    assert found is not None
    assert found.piece == 2


@pytest.mark.parametrize(('won', 'told'), [(7.9, False), (8.1, True)])
def test_a_change_is_reported_if_it_wins_eight_nats(
    monkeypatch: pytest.MonkeyPatch, won: float, told: bool
) -> None:
    """The pull is that with which four pieces win so much, by `_won` solved for it."""
    gained = 2.0 * (won + 0.5 * np.log(1.0 + 9.0 * 40.0)) * (40.0 + 1.0 / 9.0)
    found = _found(monkeypatch, 8, slice(4, None), float(np.sqrt(gained)) / 4.0)
    assert (found is not None) == told


def test_a_change_in_five_pieces_may_be_chance_and_four_cannot_be_divided(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One order in ten of five pieces has the two that pull at its end; the limit is 0.04."""
    assert _found(monkeypatch, 5, slice(3, None), 99.0) is None
    monkeypatch.setattr(change_point, 'CHANCE', 0.2)
    found = _found(monkeypatch, 5, slice(3, None), 99.0)
    assert found is not None
    assert found.piece == 3
    assert _found(monkeypatch, 4, slice(2, None), 99.0) is None
