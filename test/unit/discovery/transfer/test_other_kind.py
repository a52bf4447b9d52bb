"""Effects are judged in flight of another kind, position and attitude apart."""

from types import SimpleNamespace

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.transfer import other_kind
from lta_discovery.transfer.candidate_groups import (
    AIR,
    CandidateGroup,
    HULL,
    list_candidate_groups,
    LOPSIDED,
)
from lta_discovery.transfer.other_kind import judge_by_kind, KindSplit
from lta_model.vehicle import load_vehicle
import numpy as np

GOOD, BAD, IDLE = (CandidateGroup(name, (k,)) for k, name in enumerate(('good', 'bad', 'idle')))


def test_a_mirrored_hull_is_one_candidate_without_lopsided_coefficients() -> None:
    known = list_free_parameters(NominalVehicle.from_vehicle(load_vehicle('rgblimp')))
    groups = {one.name: one for one in list_candidate_groups(known)}
    names = {known[k].name for k in groups[HULL].knobs}
    assert {name.partition('.')[0] for name in names} == set(AIR)
    assert not names & LOPSIDED
    lopsided = {one.name: one for one in list_candidate_groups(known, mirrored=False)}
    assert {known[k].name for k in lopsided[HULL].knobs} >= LOPSIDED


def judged(monkeypatch, groups, ratio):
    """Return a judgement where each effect multiplies some errors by `ratio(name)`."""

    def errors(_splits, some, _values):
        out = {('slow', 'position'): np.full(3, 4.0), ('slow', 'attitude'): np.full(3, 1.0)}
        for one in some:
            for channel, factor in ratio(one.name).items():
                out['slow', channel] = out['slow', channel] * factor**2
        return out

    monkeypatch.setattr(other_kind, '_errors_by_kind', errors)
    monkeypatch.setattr(other_kind, '_fit', lambda *given: given[-1])
    sight = SimpleNamespace(flights=[None])
    return judge_by_kind(sight, groups, np.zeros(3), [KindSplit(sight, {'slow': [0]})])


def test_an_effect_that_trades_attitude_for_position_is_rejected(monkeypatch) -> None:
    found = judged(
        monkeypatch,
        [GOOD, BAD, IDLE],
        lambda name: {
            'good': {'position': 0.7, 'attitude': 0.9},
            'bad': {'position': 0.5, 'attitude': 1.2},
            'idle': {'position': 1.01, 'attitude': 0.99},
        }[name],
    )
    assert [one.name for one in found.accepted] == ['good', 'idle']
    (lost,) = found.rejected
    assert (lost.name, lost.kind, lost.channel) == ('bad', 'slow', 'attitude')
    assert '20 % worse' in lost.sentence
    np.testing.assert_allclose(found.kinds[0].attitude, 0.9 * 0.99)
    np.testing.assert_allclose(found.kinds[0].position, 0.7 * 1.01)


def test_effects_that_help_each_other_are_kept_together(monkeypatch) -> None:
    """Both alone are harmful; together they are not, so removing either is worse."""

    def errors(_splits, some, _values):
        size = np.full(3, {0: 1.0, 1: 1.5, 2: 0.6}[len(some)] ** 2)
        return {('slow', 'position'): size, ('slow', 'attitude'): size}

    monkeypatch.setattr(other_kind, '_errors_by_kind', errors)
    monkeypatch.setattr(other_kind, '_fit', lambda *given: given[-1])
    sight = SimpleNamespace(flights=[None])
    found = judge_by_kind(sight, [GOOD, BAD], np.zeros(3), [KindSplit(sight, {'slow': [0]})])
    assert len(found.accepted) == 2
    assert not found.rejected


def test_a_difference_within_chance_is_none() -> None:
    """One part is far worse and all others are better: the sum proves nothing."""
    other = {('slow', 'position'): np.ones(20)}
    own = {('slow', 'position'): np.where(np.arange(20) < 1, 6.0, 0.9)}
    assert own['slow', 'position'].mean() > 1.1
    assert other_kind._worst('wind', own, other).ratio == 1.0
    assert other_kind._worst('wind', {k: 1.2 * v for k, v in other.items()}, other).ratio > 1.09
    # Two flights that differ by their mean difference, and a single one
    pair = {('slow', 'position'): np.ones(2)}
    assert other_kind._worst('wind', {k: np.array([1.0, 1.4]) for k in pair}, pair).ratio == 1.0
    lone = {('slow', 'position'): np.ones(1)}
    assert other_kind._worst('wind', {k: 2.0 * v for k, v in lone.items()}, lone).ratio == 1.0


def test_a_forecast_that_diverges_rejects_an_effect() -> None:
    """Left out, or within chance, it would count for the effect."""
    where = 'slow', 'position'
    other = {where: np.ones(20)}
    own = {where: np.where(np.arange(20) < 1, np.inf, 0.5)}
    found = other_kind._worst('wind', own, other)
    assert found.ratio == np.inf
    assert found.sentence == (
        'wind: rejected, as forecasts of position with it diverge in flight of another kind (slow)'
    )
    # Where the vehicle file diverges, too, the other parts decide
    assert other_kind._worst('wind', own, {where: own[where] / 0.5}).ratio == 0.5**0.5
    assert other_kind._worst('wind', {where: np.full(20, np.inf)}, own).ratio == np.inf


def flight(speeds: np.ndarray, turns: np.ndarray):
    """Return what `split_by_kind` looks at of a flight."""
    start = np.zeros((len(speeds), 13))
    start[:, 7], start[:, 12] = speeds, turns
    cut = SimpleNamespace(start=start, first=np.arange(len(speeds)))
    return SimpleNamespace(replay=SimpleNamespace(cut=cut, first=cut.first))


def test_pieces_are_split_where_they_differ(monkeypatch) -> None:
    def some(one, which):
        start = one.replay.cut.start[which]
        return flight(start[:, 7], start[:, 12])

    monkeypatch.setattr(other_kind, 'select_pieces', some)
    monkeypatch.setattr(
        other_kind, 'ForecastFitter', lambda _n, flights, _l: SimpleNamespace(flights=flights)
    )
    speeds = np.concatenate([np.full(30, 0.3), np.full(70, 0.5), np.full(50, 0.505)])
    found = other_kind.split_by_kind(None, [flight(speeds, np.full(150, 0.2))], 0.01)
    (split,) = found  # all turn alike
    (kind,) = split.kinds  # the fast ones are like the others
    assert kind.startswith('slower than')
    (inside,) = split.kinds[kind]
    assert split.sight.flights[inside].replay.cut.start[:, 7].max() == 0.3
