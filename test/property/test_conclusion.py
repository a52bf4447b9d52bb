"""Laws over what studies say: whatever the numbers, no page asserts and retracts."""

from dataclasses import replace
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_challenge.contradictions import (
    BETTER,
    DOUBT,
    find_contradictions,
    FITS,
    IDLE,
    NOTHING,
    render_study,
    UNFIT,
)
from lta_discovery.conclusion import draw_conclusion
from lta_discovery.finding import (
    AssumedValue,
    ChannelErrors,
    NamedEffect,
    ParameterEstimate,
    SearchCandidate,
    StudyResult,
)
from lta_discovery.fit.bounds import format_bounds_warning
from lta_discovery.forecast.forecast_warnings import list_forecast_warnings, WHOLE
from lta_discovery.unmodeled.draught import DraughtEstimate
from lta_discovery.unmodeled.unexplained_force import Remainder
from lta_model.effects import EFFECTS
import pytest

KNOBS = [
    f'{name}.{effect.parameters[0].name}'
    for name, effect in EFFECTS.items()
    if len(effect.parameters) > 1
]
SIZES = st.floats(0.001, 1.0)
NATS = st.floats(-20.0, 200.0)


@st.composite
def gaps(draw, named):
    """Errors of one channel at one horizon; without names, only tolerances make a difference."""
    before, tuned, after, coast = (draw(SIZES) for _ in range(4))
    after = after if named else tuned
    shrink, half = 1.0 - after / before, draw(st.floats(0.01, 0.5))
    channel = draw(st.sampled_from(['position', 'attitude', 'q']))
    ends = shrink - half, shrink + half
    added = 1.0 - after / tuned
    return ChannelErrors(
        channel, 'm', draw(st.sampled_from([1.0, 3.0, 5.0])), before, tuned, after, coast, 0.001,
        shrink, ends, 9, draw(st.just(float('nan')) | SIZES), (added - half, added + half),
    )  # fmt: skip


@st.composite
def effects(draw):
    """Return effects of the registry with values, rivals and what was assumed."""
    out = []
    for knob in draw(st.lists(st.sampled_from(KNOBS), min_size=1, max_size=3, unique=True)):
        name, _, parameter = knob.partition('.')
        value = draw(st.floats(-1.0, 1.0))
        learned = ParameterEstimate(
            parameter, '1', 0.0, value, (value - 0.1, value + 0.1), draw(st.booleans())
        )
        rivals = draw(st.lists(st.sampled_from(KNOBS), max_size=2, unique=True))
        taken = (AssumedValue('radius', 'm', 0.0225),) if draw(st.booleans()) else ()
        out.append(NamedEffect(name, (knob,), (learned,), draw(NATS), tuple(rivals), taken))
    return tuple(out)


@st.composite
def rungs(draw):
    """One candidate of a round."""
    numbers = (draw(NATS) for _ in range(3))
    return SearchCandidate(
        draw(st.sampled_from(KNOBS)), *numbers, draw(st.floats(0.0, 9.0)), False
    )


@st.composite
def findings(draw):
    """Whatever a study may come to."""
    verdict = draw(
        st.sampled_from(['none', 'named', 'unexplained', 'named+unexplained', 'not_identifiable'])
    )
    may = verdict == 'not_identifiable' and draw(st.booleans())
    named = draw(effects()) if 'named' in verdict or may else ()
    remains, said = (), ()
    if 'unexplained' in verdict:
        if draw(st.booleans()):
            remains = (Remainder('surge', 0.007, 9.0, ('surge speed',), 0.8),)
        said = ('an oscillation of the pitch rate at 2.0 Hz, 0.02 rad/s',)
    ladder = [draw(st.lists(rungs(), max_size=3))]
    ladder += [
        [SearchCandidate(knob, 60.0, 30.0, 30.0, 0.3, True)] for one in named for knob in one.knobs
    ]
    if draw(st.booleans()):  # what a round named and the proof gave up
        ladder.append([SearchCandidate(draw(st.sampled_from(KNOBS)), 12.0, 7.0, 7.0, 0.3, True)])
    told_gaps = tuple(draw(st.lists(gaps(bool(named)), max_size=4)))
    if told_gaps and draw(st.booleans()):  # position and attitude, so that a refit can be best
        told_gaps = tuple(
            replace(gap, channel=channel) for gap in told_gaps[:2] for channel in WHOLE
        )
    strained = ('vehicle.mass',) if draw(st.booleans()) else ()
    warnings = format_bounds_warning(strained)
    return StudyResult(
        verdict, named, tuple(map(tuple, ladder)), (), told_gaps, True, remains,
        (*warnings, *list_forecast_warnings(told_gaps)), 1,
        {'train': ('a',), 'confirm': ('b',)}, 'gtmab',
        unexplained=said, draught=DraughtEstimate(0.001, 0.003) if draw(st.booleans()) else None,
        strained=strained,
    )  # fmt: skip


@settings(max_examples=150)
@given(findings())
def test_no_study_contradicts_itself(found: StudyResult) -> None:
    assert find_contradictions(found) == []


@pytest.fixture
def named() -> StudyResult:
    """Drag was missing, and the flights cannot tell which."""
    drag = NamedEffect(
        'linear_drag', ('linear_drag.surge',),
        (ParameterEstimate('surge', 'N s/m', 0.01, 0.02, (0.019, 0.021)),), 40.0,
        ('quadratic_drag.surge',),
    )  # fmt: skip
    gap = ChannelErrors('position', 'm', 5.0, 0.3, 0.2, 0.1, 1.0, 0.002, 0.66, (0.6, 0.7), 9)
    gap = replace(gap, added_ci95=(0.4, 0.6))
    rungs = ((SearchCandidate('linear_drag.surge', 30.0, 20.0, 20.0, 0.1, True),),)
    bags = {'train': ('a',), 'confirm': ('b',)}
    return StudyResult('named', (drag,), rungs, (), (gap,), True, (), (), 1, bags, 'gtmab')


def give_added(told: dict[str, Any], ends: tuple[float, float]) -> dict[str, Any]:
    """Return the JSON of a study whose effects add that much to fitted tolerances."""
    return {**told, 'gaps': [{**gap, 'added_ci95': list(ends)} for gap in told['gaps']]}


def give_advice(told: dict[str, Any], advice: str) -> dict[str, Any]:
    """Return the JSON of a study with another advice."""
    return {**told, 'conclusion': {**told['conclusion'], 'advice': advice}}


def retract(told: dict[str, Any]) -> dict[str, Any]:
    """Return the JSON of a study that does not say any more that its effects are missing."""
    return {**told, 'conclusion': {**told['conclusion'], 'asserted': False}}


def test_the_laws_find_a_page_that_retracts(
    named: StudyResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each law, broken by one word in one place."""
    assert find_contradictions(named) == []
    place = 'lta_challenge.contradictions'
    said = render_study(named)
    broken = {
        'the headline does not mention': said._replace(headline='Linear drag (surge) is missing.'),
        'the advice is not to use': said._replace(rest=f'{said.rest} keep the vehicle file'),
        'the study states a doubt': said._replace(rest=f'{said.rest} no cause for doubt'),
        'a text is cut off': said._replace(
            terminal=f'{said.terminal} linear_dr\N{HORIZONTAL ELLIPSIS}'
        ),
        'linear_drag is cut off': said._replace(
            terminal=said.terminal.replace('linear_drag', 'linear')
        ),
        'not in the result': said._replace(ladder='Round 1: net lift is named'),
        'says that no force remains': said._replace(tiles='no unexplained force or moment'),
        'shows a vehicle-file value': said._replace(effects='not in the vehicle file'),
        'headline and JSON disagree': said._replace(headline=said.headline.partition(':')[0]),
        'give different advice': said._replace(terminal=said.terminal.replace('Use', 'Keep')),
        'improve no forecast over': said._replace(json=give_added(said.json, (-0.1, 0.2))),
        'but the JSON asserts them': said._replace(headline=f'It is so, but {IDLE} it'),
        'but their file is advised': said._replace(headline=f'It is so, but {IDLE} it'),
        'headline and tiles disagree': said._replace(tiles='1 possible effect'),
        'the JSON verdict names': said._replace(json=retract(said.json)),
        'a tile names': said._replace(json=retract(said.json)),
        'the terminal names': said._replace(json=retract(said.json)),
        'a search round names': said._replace(json=retract(said.json)),
        'but nothing is named': said._replace(json=retract(said.json)),
        'verdict or tile do not name it': said._replace(tiles='1 effect'),
        'a gain by effects that are not': said._replace(json=give_advice(said.json, 'again')),
    }
    other = replace(
        named, ladder=((SearchCandidate('net_lift.force', 30.0, 20.0, 20.0, 0.1, True),),)
    )
    other = replace(other, unexplained=('a line',), verdict='named+unexplained')
    for words, changed in broken.items():
        monkeypatch.setattr(f'{place}.render_study', lambda _found, changed=changed: changed)
        finding = other if words in ('not in the result', 'says that no force remains') else named
        assert any(words in one for one in find_contradictions(finding)), words


def test_each_phrase_of_the_laws_is_one_that_some_study_says(named: StudyResult) -> None:
    """A law about words that no page has any more could not fail."""
    gap = named.gaps[0]
    tight = replace(gap, tuned=0.29, after=0.29, shrink=0.03, shrink_ci95=(-0.1, 0.1))
    lost = replace(gap, after=0.4, shrink=-0.3, shrink_ci95=(-0.5, -0.1))
    told_gaps = (gap, lost, replace(gap, tuned=0.05), tight)
    bare = replace(named, verdict='none', effects=(), ladder=())
    sure = replace(named.effects[0], confusable_with=())
    held = sure.parameters[0]._replace(in_file=False)
    lacking = replace(sure, parameters=(held,), assumed=(AssumedValue('radius', 'm', 0.0225),))
    findings = [
        *(
            replace(named, gaps=(one,), warnings=tuple(list_forecast_warnings([one])))
            for one in told_gaps
        ),
        replace(named, effects=(lacking,)),
        replace(named, verdict='not_identifiable', unexplained=('a line',)),
        bare,
        replace(bare, gaps=(tight,)),
        replace(
            bare, gaps=(tight,), strained=('a',), warnings=tuple(format_bounds_warning(['a']))
        ),
    ]
    said = '\n'.join(render_study(one).text_without_json for one in findings)
    phrases = (
        *BETTER, *DOUBT, *UNFIT, FITS, IDLE, NOTHING, 'Unexplained:',
        'no unexplained force or moment', 'no cause for doubt', 'not in the vehicle file',
        'assumed and not fitted', ' fly --vehicle', 'Keep the vehicle file',
        'linear drag (surge) is named',
    )  # fmt: skip
    assert [one for one in phrases if one not in said] == []


@pytest.mark.parametrize(
    ('changes', 'advice'),
    [
        ({}, 'use'),
        ({'added_ci95': (-0.02, 0.6)}, 'measure'),  # within the uncertainty
        ({'added_ci95': (float('nan'), float('nan'))}, 'measure'),  # which is not known
        ({'added_ci95': (-0.02, 0.6), 'tuned': 0.25}, 'again'),  # tolerances explain little
        ({'after': 0.2}, 'measure'),
    ],
)
def test_an_effect_that_adds_nothing_to_fitted_tolerances_is_not_advised(
    named: StudyResult, changes: dict[str, Any], advice: str
) -> None:
    found = replace(named, gaps=(replace(named.gaps[0], **changes),))
    said, idle = draw_conclusion(found), advice != 'use'
    assert (said.advice, said.idle, said.asserted) == (advice, idle, not idle)
    text = render_study(found)
    assert (IDLE in text.headline) == (' may be missing' in text.headline) == idle
    assert ('vehicle.yaml in the results' in text.text_without_json) == (not idle)
    assert (' fly --vehicle' in text.commands) == (not idle)
    assert ('reduces the position error after 5 s from 30 cm to 20' in text.headline) == (
        advice == 'measure'
    )
    assert find_contradictions(found) == []


def test_an_effect_may_help_attitude_or_the_readings_of_its_sensor(named: StudyResult) -> None:
    vain = replace(named.gaps[0], added_ci95=(-0.1, 0.1))
    turn, rate, force = (
        replace(named.gaps[0], channel=channel) for channel in ('attitude', 'p', 'fx')
    )
    assert draw_conclusion(replace(named, gaps=(vain, turn))).gain == turn
    assert draw_conclusion(replace(named, gaps=(vain, rate))).idle
    gyro = replace(named.effects[0], name='gyro_bias', knobs=('gyro_bias.x',))
    for gap, idle in ((rate, False), (force, True)):
        assert draw_conclusion(replace(named, effects=(gyro,), gaps=(vain, gap))).idle == idle


def test_the_advice_follows_the_forecasts(named: StudyResult) -> None:
    gap = named.gaps[0]
    assert draw_conclusion(named).advice == 'use'
    assert draw_conclusion(named).gain == gap
    worse = replace(gap, after=0.4, shrink=-0.3, shrink_ci95=(-0.5, -0.1))
    assert draw_conclusion(replace(named, gaps=(worse,))).advice == 'keep'
    no_better = replace(gap, after=0.32, tuned=0.32, shrink=-0.07, shrink_ci95=(-0.2, 0.1))
    assert draw_conclusion(replace(named, gaps=(no_better,))).advice == 'again'
    vain = replace(gap, tuned=0.05)
    assert draw_conclusion(replace(named, gaps=(vain,))).advice == 'again'
    for changed in (worse, vain):
        assert draw_conclusion(replace(named, gaps=(changed,))).gain is None
    bare = replace(named, verdict='none', effects=(), ladder=())
    assert draw_conclusion(bare).advice == 'measure'  # tolerances alone take a third of the error
    tight = replace(gap, tuned=0.29, after=0.29, shrink=0.03, shrink_ci95=(-0.1, 0.1))
    assert draw_conclusion(replace(bare, gaps=(tight,))).advice == 'keep'
    assert (
        draw_conclusion(replace(bare, gaps=(tight,), strained=('vehicle.mass',))).advice
        == 'measure'
    )
    unsure = replace(named, verdict='not_identifiable')
    assert (draw_conclusion(unsure).advice, draw_conclusion(unsure).asserted) == ('again', False)
