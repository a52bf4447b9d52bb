"""A model that does not beat coasting 3 s ahead is no improvement, whatever it improves."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

from lta_challenge.contradictions import find_contradictions, render_study
from lta_discovery.conclusion import draw_conclusion, forget_refit
from lta_discovery.finding import (
    ChannelErrors,
    NamedEffect,
    ParameterEstimate,
    StudyResult,
    Verdict,
)
from lta_discovery.page.verdict_text import (
    build_tiles,
    format_advice,
    format_details,
    format_headline,
    list_learned_file_commands,
)
from lta_discovery.results.discovery_json import to_dict
from lta_discovery.results.terminal import format_prediction_errors
import pytest

DRAG = ParameterEstimate('surge', 'N s/m', 0.0, 0.02, (0.015, 0.025))
NAMED = NamedEffect('linear_drag', ('linear_drag.surge',), (DRAG,), 50.0)


def study(coast: Mapping[float, float], *, named: bool = True) -> StudyResult:
    """Return a study in which the error falls to a tenth, by the errors of coasting."""
    gap = ChannelErrors('position', 'm', 0.0, 1.0, 0.5, 0.1, 0.0, 0.01, 0.9, (0.8, 0.95), 20)
    gap = replace(gap, added_ci95=(0.7, 0.9))
    gaps = tuple(replace(gap, horizon_s=at, coast=error) for at, error in coast.items())
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


def refit_study(*, named: bool, verdict: Verdict = 'none') -> StudyResult:
    """Return a study whose file is off, and of which the refitted file forecasts best."""
    found = study({3.0: 0.9, 5.0: 1.0}, named=named)
    gaps = [replace(gap, refitted=0.05) for gap in found.gaps]
    gaps += [replace(gap, channel='attitude', unit='rad') for gap in gaps]
    return replace(
        found,
        gaps=tuple(gaps),
        verdict='named' if named else verdict,
        offsets=('the mass is 1.2',),
    )


@pytest.mark.parametrize('verdict', ['none', 'unexplained'])
def test_headline_and_advice_are_the_refitted_file_where_it_forecasts_best(
    verdict: Verdict,
) -> None:
    found = refit_study(named=False, verdict=verdict)
    assert draw_conclusion(found).advice == 'refitted'
    headline, advice = format_headline(found), format_advice(found)
    # The rest stands below the headline
    assert headline.count('. ') == 1
    assert format_details(found) == 'The vehicle file is off (the mass is 1.2).'
    assert headline.endswith(
        'With all numbers refitted, the position error after 5 s is 5 cm (vehicle file 1 m, '
        'coasting 1 m).'
    )
    assert advice.startswith('To predict flights, use refitted.yaml in the results folder, in its')
    assert advice.endswith('For other flights, calibrate the vehicle file first.')
    tile = build_tiles(found)[2]
    assert (tile.value, tile.unit, build_tiles(found)[3].value) == ('5', 'cm', '95')
    assert list(list_learned_file_commands(found, Path('out'))) == ['show the changes']
    assert find_contradictions(found) == []


def test_named_effects_keep_their_advice_beside_a_better_refitted_file() -> None:
    found = refit_study(named=True)
    assert draw_conclusion(found).advice == 'use'
    assert 'Calibrate first' not in format_headline(found)
    assert 'With all numbers refitted' in format_headline(found)
    assert 'use refitted.yaml' in format_advice(found)
    assert find_contradictions(found) == []


def test_undecided_flights_ask_for_another_one_beside_the_refitted_file() -> None:
    found = refit_study(named=False, verdict='not_identifiable')
    advice = format_advice(found)
    assert advice.startswith('Record another flight')
    assert 'use refitted.yaml' in advice
    assert find_contradictions(found) == []


def test_a_refitted_file_that_loses_to_coasting_after_three_seconds_is_not_advised() -> None:
    found = refit_study(named=False)
    near, *rest = found.gaps
    found = replace(found, gaps=(replace(near, coast=0.04), *rest))
    assert draw_conclusion(found).refitted is None
    assert 'Calibrate first' in format_headline(found)
    assert find_contradictions(found) == []


@pytest.mark.parametrize(
    ('old', 'new', 'law'),
    [
        ('With all numbers refitted, ', '', 'headline and JSON disagree on whether the refit'),
        ('The vehicle file is off', 'Calibrate first', 'but the headline says to calibrate'),
    ],
)
def test_the_laws_find_a_headline_that_hides_the_refitted_file(
    monkeypatch: pytest.MonkeyPatch, old: str, new: str, law: str
) -> None:
    found = refit_study(named=False)
    said = render_study(found)
    said = said._replace(headline=said.headline.replace(old, new))
    monkeypatch.setattr('lta_challenge.contradictions.render_study', lambda _found: said)
    assert any(law in one for one in find_contradictions(found))


def test_the_laws_find_a_headline_of_three_sentences(monkeypatch: pytest.MonkeyPatch) -> None:
    found = refit_study(named=False)
    said = render_study(found)
    conclusion = said.json['conclusion']
    conclusion |= {'headline': said.headline, 'details': ''}
    monkeypatch.setattr('lta_challenge.contradictions.render_study', lambda _found: said)
    assert find_contradictions(found) == ['the headline has more than two sentences']


def test_the_bars_are_those_of_the_calibrated_file_after_a_calibration() -> None:
    found = study({3.0: 0.5, 5.0: 1.0})
    for calibration, file in ((None, 'vehicle'), (SimpleNamespace(), 'calibrated')):
        lines = [
            line.plain
            for line in format_prediction_errors(replace(found, calibration=calibration))
        ]
        assert f'less than with the {file} file' in lines[0]
        assert lines[2].startswith(f'  the {file} file ')
