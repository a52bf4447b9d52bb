"""A threshold, of which no slope at 0 tells, is tried where something remains and nothing fits."""

from types import SimpleNamespace
from unittest import mock

from lta_discovery.selection.candidate_acceptance import CandidateTrial
from lta_discovery.selection.effect_search import EffectSearch, SelectionRound
import pytest

DEADBAND = 'motor_deadband.threshold'


def _trial(name: str) -> CandidateTrial:
    return CandidateTrial(name, 9.0, 9.0, 9.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ('first', 'loud', 'knobs', 'asked', 'named'),
    [
        ('', True, ('a', DEADBAND), [('a',), ('b',), (DEADBAND,)], DEADBAND),
        ('a', True, ('a', DEADBAND), [('a',)], 'a'),  # something fits
        ('', False, ('a', DEADBAND), [('a',)], ''),  # nothing remains
        ('', True, ('a',), [('a',), ('b',)], ''),  # no such candidate
    ],
)
def test_a_threshold_is_tried_last(
    first: str, loud: bool, knobs: tuple[str, ...], asked: list[tuple[str, ...]], named: str
) -> None:
    naming = object.__new__(EffectSearch)
    naming._names = list(knobs)
    naming._displacing = SimpleNamespace(has_remainder=lambda fits: loud)
    seen: list[tuple[str, ...]] = []

    def tried(names, fits, glance, failed=()):
        seen.append(tuple(glance))
        (name,) = glance
        found = name if name in (first, DEADBAND) else ''
        return SelectionRound((_trial(name),), (), found), 'then' if found else fits

    naming._try_candidates = tried
    glances = mock.Mock(side_effect=[{'a': (9.0, ())}, {'b': (9.0, ())}])
    naming._shortlist_candidates = glances
    step, then = naming._run_round((), 'fits')
    assert seen == asked
    assert (step.named, then) == (named, 'then' if named else 'fits')
    assert {trial.name for trial in step.trials} == {name for (name,) in asked}


def test_a_threshold_that_the_first_glance_judged_is_not_judged_again() -> None:
    naming = object.__new__(EffectSearch)
    naming._names = [DEADBAND]
    naming._displacing = SimpleNamespace(has_remainder=lambda fits: True)
    naming._shortlist_candidates = mock.Mock(side_effect=[{DEADBAND: (9.0, ())}, {'b': (9.0, ())}])
    naming._try_candidates = mock.Mock(side_effect=[
        (SelectionRound((_trial(DEADBAND),), (), ''), 'fits'),
        (SelectionRound((_trial('b'),), (), ''), 'fits'),
    ])  # fmt: skip
    step, _ = naming._run_round((), 'fits')
    assert naming._try_candidates.call_count == 2
    assert step.named == ''
