"""A model that does not beat coasting 3 s ahead is no improvement, whatever it improves."""

from collections.abc import Mapping
from dataclasses import replace

from lta_challenge.contradictions import find_contradictions
from lta_discovery.conclusion import draw_conclusion, forget_refit
from lta_discovery.finding import ChannelErrors, NamedEffect, ParameterEstimate, StudyResult
from lta_discovery.page.verdict_text import format_advice, format_headline
from lta_discovery.results.discovery_json import to_dict
import pytest

DRAG = ParameterEstimate('surge', 'N s/m', 0.0, 0.02, (0.015, 0.025))
NAMED = NamedEffect('linear_drag', ('linear_drag.surge',), (DRAG,), 50.0)


def study(coast: Mapping[float, float], *, named: bool = True) -> StudyResult:
    """Return a study in which the error falls to a tenth, by the errors of coasting."""
    gaps = tuple(
        ChannelErrors('position', 'm', at, 1.0, 0.5, 0.1, error, 0.01, 0.9, (0.8, 0.95), 20)
        for at, error in coast.items()
    )
    effects = (NAMED,) if named else ()
    verdict = 'named' if named else 'none'
    return StudyResult(verdict, effects, (), (), gaps, True, (), (), 1, {}, 'gtmab')


def test_a_model_that_beats_coasting_is_an_improvement() -> None:
    found = study({3.0: 0.5, 5.0: 1.0})
    assert draw_conclusion(found).gain is not None
    assert 'coasting' not in format_headline(found)
    assert find_contradictions(found) == []


@pytest.mark.parametrize('named', [True, False])
def test_a_model_that_loses_to_coasting_is_none(*, named: bool) -> None:
    found = study({3.0: 0.08, 5.0: 1.0}, named=named)
    said = draw_conclusion(found)
    assert said.gain is None
    assert said.useless is not None
    assert said.advice == ('again' if named else 'measure')
    assert 'no improvement: coasting' in format_headline(found)
    assert 'falls from' not in format_headline(found)
    assert to_dict(found)['gaps'][0]['coast'] == 0.08
    assert find_contradictions(found) == []


@pytest.mark.parametrize(
    ('position', 'attitude', 'held_out', 'advised'),
    [(0.05, 0.05, True, True), (0.05, 0.095, True, False), (0.05, 0.05, False, False)],
)
def test_a_refitted_file_is_advised_where_it_forecasts_position_and_attitude_best(
    position: float, attitude: float, held_out: bool, advised: bool
) -> None:
    """Named effects forecast with an error of 0.1; a tenth less counts as clearly better."""
    found = study({5.0: 1.0})
    (gap,) = found.gaps
    gaps = (
        replace(gap, refitted=position),
        replace(gap, channel='attitude', unit='rad', refitted=attitude),
    )
    found = replace(found, gaps=gaps, held_out=held_out)
    sentence = 'use refitted.yaml: its position error after 5 s is 5 cm.'
    assert (sentence in format_advice(found)) == advised
    assert 'refitted.yaml' not in format_advice(forget_refit(found))
