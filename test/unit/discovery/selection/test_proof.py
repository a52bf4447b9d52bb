"""A name gives way to another that explains more, whether they look alike or not."""

from types import SimpleNamespace
from unittest import mock

from lta_discovery.fit.evidence import Prior
from lta_discovery.fit.flight_group import LinearizedGroup
from lta_discovery.selection.effect_search import SelectionRound
from lta_discovery.selection.effect_verification import EffectVerification
import numpy as np
import pytest


@pytest.mark.parametrize(
    ('linear', 'alike', 'refitted', 'named', 'others'),
    [
        (104.2, True, 108.0, 'other', {}),  # alike, but better by more than a tie
        (104.2, True, 102.0, 'name', {'other': True}),  # promised and not kept
        (102.9, True, 108.0, 'name', {'other': True}),  # another word for it: never refitted
        (96.9, True, 108.0, 'name', {}),
        (96.0, False, 104.0, 'other', {}),
        (96.0, False, 98.0, 'name', {'other': False}),
    ],
)
def test_the_better_of_two_names_stands(
    linear: float, alike: bool, refitted: float, named: str, others: dict[str, bool]
) -> None:
    proof = object.__new__(EffectVerification)
    proof._sizes, proof._rival_sizes = {}, {}
    full, then = SimpleNamespace(evidence=100.0), SimpleNamespace(evidence=refitted)
    near = mock.patch.object(
        EffectVerification, '_find_near_rivals', return_value={'other': (linear, alike)}
    )
    with near, mock.patch.object(EffectVerification, '_refit_without', return_value=then):
        found, fitted, name = proof._compare_with_rivals('name', ('name',), full)
    assert name == named
    assert fitted is (then if named == 'other' else full)
    assert found == others


def _proof(*knobs: tuple[str, float]) -> EffectVerification:
    """Return a proof without flights whose candidates have these names and typical sizes."""
    proof = object.__new__(EffectVerification)
    proof.knobs = [SimpleNamespace(name=name, typical=typical) for name, typical in knobs]
    proof._order = [name for name, _ in knobs]
    proof.fitter, proof._sizes, proof._rival_sizes = mock.Mock(), {}, {}
    return proof


def _worth(evidence: float) -> SimpleNamespace:
    return SimpleNamespace(evidence=evidence)


def test_the_cost_of_an_effect_is_refitted_if_it_is_less_than_60_nats() -> None:
    """A larger cost is taken as the model linearised about the full fit has it."""
    asked = []
    linear, refitted = {'a': 139.9, 'b': 140.1, 'c': 140.0}, {'b': 150.0}

    def without(self, last, name, names):
        asked.append((name, names))
        return _worth(linear[name])

    with (
        mock.patch.object(EffectVerification, '_remove_effect', without),
        mock.patch.object(
            EffectVerification,
            '_refit_without',
            lambda self, last, name, _: _worth(refitted[name]),
        ),
    ):
        costs = _proof()._removal_costs(('a', 'b', 'c'), _worth(200.0), _worth(1.0))
    assert costs == pytest.approx({'a': 60.1, 'b': 50.0, 'c': 60.0})
    assert asked == [('a', ('b', 'c')), ('b', ('a', 'c')), ('c', ('a', 'b'))]
    assert _proof()._removal_costs(('a',), _worth(200.0), _worth(180.0)) == {'a': 20.0}


def test_rivals_resemble_the_effect_and_lose_few_nats() -> None:
    """
    A rival's column has a cosine above 0.3 with that of the effect, and counts as alike above 0.9.

    In place of the effect it loses less than 15 nats in the linearised model.
    """
    proof = _proof(
        ('a', 1.0), ('named', 1.0), ('none', 0.0), ('faint', 1.0), ('some', 1.0), ('twin', 1.0),
        ('nan', 1.0), ('far', 1.0), ('just', 1.0),
    )  # fmt: skip
    cosines = [[1.0, 0.29, 0.31, -0.91, np.nan, 0.95, 0.89]]
    lost = {'some': 14.9, 'twin': 3.0, 'far': 15.1, 'just': -2.0}
    asked = []

    def without(self, last, name, names):
        asked.append(names)
        return _worth(100.0 - lost[names[0]])

    likeness = mock.patch(
        'lta_discovery.selection.effect_verification.column_cosines',
        return_value=np.array(cosines),
    )
    full = SimpleNamespace(evidence=100.0, reduced='r', prior='p')
    with likeness as alike, mock.patch.object(EffectVerification, '_remove_effect', without):
        near = proof._find_near_rivals('a', ('a', 'named'), full)
    assert alike.call_args.args[2] == ['a', 'faint', 'some', 'twin', 'nan', 'far', 'just']
    assert asked == [(name, 'named') for name in ('some', 'twin', 'far', 'just')]
    assert [*near] == ['just', 'twin', 'some']
    assert near == {
        'just': (pytest.approx(102.0), False),
        'twin': (pytest.approx(97.0), True),
        'some': (pytest.approx(85.1), False),
    }


def test_the_two_best_rivals_are_refitted_and_all_within_a_tie_are_listed() -> None:
    """Further rivals keep the evidence of the linearised model; less than 3 nats is a tie."""
    near = {'b': (99.0, False), 'c': (98.5, False), 'd': (97.1, False), 'e': (97.0, False)}
    refitted = {'b': 97.2, 'c': 103.0}
    asked = []

    def changed(self, last, name, names):
        asked.append((name, names))
        return _worth(refitted[names[1]])

    with (
        mock.patch.object(EffectVerification, '_find_near_rivals', return_value=near),
        mock.patch.object(EffectVerification, '_refit_without', changed),
    ):
        found, _, name = _proof()._compare_with_rivals('a', ('x', 'a'), _worth(100.0))
    assert asked == [('a', ('x', 'b')), ('a', ('x', 'c'))]
    assert name == 'a'  # a rival has to be better by more than 3 nats
    assert [*found] == ['c', 'b', 'd']


def test_measured_effects_have_a_prior_of_thirty_typical_sizes() -> None:
    """So wide a prior hardly pulls a value towards 0; its variance grows by (30 * 0.5)^2 = 225."""
    proof = _proof(('a', 0.5), ('b', 2.0))
    full = SimpleNamespace(
        prior=Prior(np.array([1.0, 2.0]), np.diag([0.1, 0.2])), group='group', deviations='these'
    )
    proof._fit_values(full, ('a',))
    prior, *others = proof.fitter.fit.call_args.args
    np.testing.assert_allclose(prior.covariance, np.diag([0.1 + 225.0, 0.2]))
    assert prior.mean.tolist() == [1.0, 2.0]
    assert others == ['group', 'these', 4]
    assert full.prior.covariance[0, 0] == 0.1


def test_an_effect_is_removed_by_holding_it_at_zero() -> None:
    proof = _proof(('a', 1.0), ('b', 1.0))
    group = LinearizedGroup((), np.array([3.0, 4.0]), np.zeros(2))
    last = SimpleNamespace(group=group, deviations='these')
    with mock.patch(
        'lta_discovery.selection.effect_verification.build_shared_prior', return_value='prior'
    ):
        proof._remove_effect(last, 'b', ('a',))
    settled = proof.fitter.fit_deviations.call_args.args
    assert settled[0].at.tolist() == [3.0, 0.0]
    assert settled[1:] == ('prior', 'these')
    begun = SimpleNamespace(prior='prior', group='group', deviations='those')
    with mock.patch.object(EffectVerification, '_remove_effect', return_value=begun):
        proof._refit_without(last, 'b', ('a',))
    assert proof.fitter.fit.call_args.args == ('prior', 'group', 'those', 4)
    assert group.at.tolist() == [3.0, 4.0]


def test_a_joint_fit_starts_at_the_point_of_the_side_that_fits_all_flights_better() -> None:
    """The deviations begin at the geometric mean of those of the sides."""
    proof = _proof(('a', 1.0))
    sides = tuple(
        SimpleNamespace(
            group=LinearizedGroup((name,), np.array([at]), np.zeros(1)), deviations=np.array(size)
        )
        for name, at, size in (('teach', 0.0, [1.0, 4.0]), ('confirm', 7.0, [9.0, 1.0]))
    )
    proof.fitter.compute_misfit.side_effect = lambda prior, group, deviations: {
        0.0: 30.0,
        7.0: 20.0,
    }[float(group.at[0])]
    with mock.patch(
        'lta_discovery.selection.effect_verification.build_shared_prior', return_value='prior'
    ):
        proof._fit_jointly(('a',), sides)
    prior, group, deviations, rounds = proof.fitter.fit.call_args.args
    assert (prior, group.pieces, rounds) == ('prior', ('teach', 'confirm'), 4)
    assert group.at.tolist() == [7.0]
    np.testing.assert_allclose(deviations, [3.0, 2.0])


def test_effects_that_cost_less_than_5_nats_are_dropped_and_the_others_ranked() -> None:
    """
    The weakest is dropped first, and the costs of the others are computed anew.

    The cost of an effect that is added later is what its trial won.
    """
    costs = [{'a': 4.9, 'b': 4.0, 'c': 30.0}, {'a': 5.0, 'c': 29.0}]
    asked = []

    def changed(self, last, name, names):
        asked.append((name, names))
        return 'changed'

    step = SimpleNamespace(named='d', trials=[SimpleNamespace(joint_evidence=12.0)], tied=('t',))
    last = SimpleNamespace(named='', trials=[], tied=())
    named = SimpleNamespace(
        names=('a', 'b', 'c'),
        fits='fits',
        bare=(SimpleNamespace(group=LinearizedGroup((1, 2), 0, 0)),) * 2,
        sizes={},
    )
    with (
        mock.patch.object(
            EffectVerification, '_fit_jointly', lambda self, names, pair: ('joined', names)
        ),
        mock.patch.object(EffectVerification, '_removal_costs', side_effect=costs),
        mock.patch.object(EffectVerification, '_refit_without', changed),
        mock.patch.object(
            EffectVerification,
            '_compare_with_rivals',
            lambda self, name, names, full: (
                ({'a': True, 'r': False}, 'swapped', 'e') if name == 'a' else ({}, full, name)
            ),
        ),
        mock.patch.object(
            EffectVerification, '_add_weak_effects', return_value=((step, last), 'full')
        ) as fainter,
        mock.patch.object(EffectVerification, '_fit_values', return_value='measured') as measured,
    ):
        found = _proof().run(named)
    assert asked == [('b', ('a', 'c'))]
    assert fainter.call_args.args == (('e', 'c'), 'swapped', 2)
    assert found.names == ('c', 'd', 'e')
    assert found.costs == {'c': 29.0, 'd': 12.0, 'e': 5.0}
    assert found.rivals == {'e': ('a', 'r'), 'c': (), 'd': ('t',)}
    assert found.unlike == {'e': ('r',), 'c': (), 'd': ()}
    assert measured.call_args.args == ('full', ('c', 'd', 'e'))
    assert (found.full, found.bare, found.measured) == ('full', ('joined', ()), 'measured')


def test_without_named_effects_the_bare_fit_is_returned() -> None:
    named = SimpleNamespace(
        names=(),
        fits='fits',
        bare=(SimpleNamespace(group=LinearizedGroup((1,), 0, 0)),) * 2,
        sizes={},
    )
    with (
        mock.patch.object(EffectVerification, '_fit_jointly', return_value='bare'),
        mock.patch.object(
            EffectVerification, '_add_weak_effects', lambda self, names, full, teach: ((), full)
        ),
    ):
        found = _proof().run(named)
    assert (found.names, found.full, found.measured) == ((), 'bare', 'bare')


@pytest.mark.parametrize(
    ('rounds', 'beside', 'added'),
    [(['x', 'y', ''], '', ['x', 'y', '']), ([''], '', ['']), (['x', 'y'], 'y', ['x', ''])],
)
def test_fainter_effects_are_added_until_a_round_names_none(
    rounds: list[str], beside: str, added: list[str]
) -> None:
    """
    Flights are settled with each of them.

    None is added beside a force outside the library on its axes.
    """
    proof = _proof()
    proof.fitter.fit_deviations.return_value = 'settled'
    quiet = SimpleNamespace(group='group', prior='prior', deviations='these')
    steps = iter(SelectionRound((), (), name) for name in rounds)
    asked = []

    def following(names, last):
        asked.append(names)
        return next(steps), quiet

    faint = mock.Mock(fit_lower_floor=lambda full: quiet, run_round=following)
    with (
        mock.patch(
            'lta_discovery.selection.effect_verification.WeakEffectSearch', return_value=faint
        ),
        mock.patch.object(
            EffectVerification,
            '_acts_with_rival',
            lambda self, name, full, teach: name == beside,
        ),
    ):
        found, full = proof._add_weak_effects(('a',), 'full', 1)
    assert [step.named for step in found] == added
    assert asked == [('a', *rounds[:k]) for k in range(len(rounds))]
    assert full == ('settled' if added[0] else 'full')
