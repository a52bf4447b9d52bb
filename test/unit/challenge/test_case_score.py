"""Cases are judged by hand-made answers and findings, and counted."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from lta_challenge.case_score import confusion_cell, score_case, ScoredCase
from lta_challenge.report import (
    build_outside_table,
    build_report,
    format_headline,
    format_markdown_page,
    format_share,
)
from lta_challenge.score import ChallengeScore
from lta_challenge.score_statistics import compute_score_figures, median_errors, shares_by_strength
import pytest


def case(
    hidden: dict[str, float],
    named: dict[str, float],
    *,
    kind: str = 'single',
    outside: str = '',
    verdict: str = 'named',
    sigma: float = 10.0,
    gap: tuple[float, float] = (0.02, 0.02),
) -> ScoredCase:
    """Return a judged case: knobs of linear_drag hidden and named with values."""
    given: dict[str, dict[str, float]] = {}
    for knob, value in hidden.items():
        effect, _, name = knob.partition('.')
        given.setdefault(effect, {})[name] = value
    answer = {
        'kind': kind, 'row': 'base', 'outside': outside, 'floors': 0.0,
        'hidden': [{'knob': k, 'value': v} for k, v in hidden.items()],
        'nominal': {'given': given},
    }  # fmt: skip

    def told(after: float) -> list[dict[str, Any]]:
        return [
            {'channel': 'position', 'horizon_s': 3.0, 'before': 0.1, 'tuned': 0.05,
             'after': after, 'coast': 1.0, 'noise_floor': 0.002}
        ]  # fmt: skip

    effects = [
        {
            'name': k.partition('.')[0], 'knobs': [k],
            'parameters': [
                {'name': k.partition('.')[2], 'before': 0.0, 'value': v,
                 'ci95': (v - 0.01, v + 0.01)}
            ],
        }
        for k, v in named.items()
    ]  # fmt: skip
    found = {
        'effects': effects, 'verdict': verdict, 'refused': '', 'gaps': told(gap[0]),
        'cpu_s': 3.0,
        'oracle': {'gaps': told(gap[1]), 'sigma': dict.fromkeys(hidden, sigma)},
    }  # fmt: skip
    return score_case(0, answer, found)


def test_the_class_counts_and_not_the_name() -> None:
    one = case({'payload.mass': 0.002}, {'net_lift.force': -0.02})
    assert one.exact
    assert one.outcome == 'exact'
    assert one.intervals == ()  # another parameter, of which the truth is not known
    assert confusion_cell(one) == ('payload', 'payload')


def test_a_further_component_of_a_vector_that_was_found_is_not_wrong() -> None:
    both = case({'cg_offset.y': 0.01}, {'cg_offset.y': 0.01, 'cg_offset.x': 0.002})
    assert both.outcome == 'exact'
    assert [one.name for one in both.intervals] == ['cg_offset.y']
    other = case({'cg_offset.y': 0.01}, {'cg_offset.x': 0.002})
    assert (other.wrong, other.missed) == (('cg_offset.x',), ('cg_offset.y',))


def test_the_size_of_an_unexplained_force_is_compared_with_the_truth() -> None:
    one = case({}, {}, kind='outside', outside='tether', verdict='unexplained')
    sizes = [(10.0, 7.1), (10.0, 12.9), (10.0, 6.9), (10.0, 13.1), (10.0, 0.0)]
    cases = [replace(one, floors=true, remainder=found) for true, found in sizes]
    name = 'effect outside the library: size of the force within 30 %'
    (figure,) = (f for f in compute_score_figures(cases) if f.name == name)
    assert (figure.share.hits, figure.share.of) == (2, 4)


def test_one_right_name_does_not_excuse_a_wrong_one() -> None:
    one = case({'linear_drag.surge': 0.03}, {'linear_drag.surge': 0.032, 'motor_lag': 0.01})
    assert one.outcome == 'wrong'
    assert one.wrong == ('motor_lag',)
    assert one.missed == ()
    assert confusion_cell(one) == ('linear_drag', 'motor_lag')


def test_intervals_and_errors_are_held_against_the_truth() -> None:
    near = case({'linear_drag.surge': 0.03}, {'linear_drag.surge': 0.033}).intervals[0]
    far = case({'linear_drag.surge': 0.03}, {'linear_drag.surge': 0.05}).intervals[0]
    assert (near.covers, far.covers) == (True, False)
    assert near.error == pytest.approx(0.1)
    assert far.error == pytest.approx(2.0 / 3.0)


def test_figures_are_counted_by_kind_and_strength() -> None:
    drag = {'linear_drag.surge': 0.03}
    both = {**drag, 'cg_offset.x': 0.01}
    cases = [
        *(case(drag, drag) for _ in range(9)),
        case(drag, {'motor_lag': 0.1}),
        case(drag, {}, sigma=4.0, verdict='none'),
        case(drag, drag, sigma=4.0),
        case(both, both, kind='pair'),
        case(both, drag, kind='pair', gap=(0.03, 0.02)),
        case({}, {}, kind='clean', verdict='none'),
        case({}, drag, kind='clean'),
        case({}, {}, kind='outside', outside='tether', verdict='unexplained'),
        case(drag, drag, kind='mixed', outside='skin', verdict='named+unexplained'),
    ]
    found = {each.name: each for each in compute_score_figures(cases)}
    clear = found['one hidden effect, 6 sigma or more: named exactly']
    assert (clear.share.hits, clear.share.of, clear.target_met) == (9, 10, 'no')
    assert found['one hidden effect, 3 to 6 sigma: named exactly'].share.value == 0.5
    assert found['one hidden effect: a wrong one named'].share[:2] == (1, 12)
    assert found['two hidden effects, both 6 sigma or more: named exactly'].share[:2] == (1, 2)
    assert found['no hidden effect: an effect named'].share[:2] == (1, 2)
    assert found['effect outside the library: unexplained force reported'].target_met == 'yes'
    assert found['one effect in and one outside the library: both reported'].target_met == 'yes'
    assert found['held-out error at most 1.05 times that of the oracle'].share[:2] == (15, 16)
    bands = {low: (exact.hits, exact.of) for low, _, exact, _, _ in shares_by_strength(cases)}
    assert bands[3.0] == (1, 2)
    assert bands[10.0] == (9, 10)
    assert median_errors(cases)['tuned'] == 0.05
    assert format_share(clear.share) == '9/10 = 90 % (60 to 98)'


def test_kinds_that_were_kept_from_discovery_have_lines_of_their_own() -> None:
    drag = {'linear_drag.surge': 0.03}
    cases = [
        *(case({}, {}, kind='outside', outside='tether', verdict='unexplained') for _ in 'abc'),
        case({}, {}, kind='outside', outside='leash', verdict='unexplained'),
        case({}, drag, kind='outside', outside='tray'),
        case(drag, drag, kind='mixed', outside='skin', verdict='named+unexplained'),
        case(drag, drag, kind='mixed', outside='drying'),
        case(drag, drag),
    ]
    assert [one.late for one in cases] == [False] * 3 + [True] * 2 + [False, True, False]
    found = {each.name: each.share[:2] for each in compute_score_figures(cases)}
    alone, beside = 'effect outside the library', 'one effect in and one outside the library'
    for when, flagged, named, both in (
        ('', (4, 5), (1, 5), (1, 2)),
        (' (early kinds)', (3, 3), (0, 3), (1, 1)),
        (' (late kinds)', (1, 2), (1, 2), (0, 1)),
    ):
        assert found[f'{alone}{when}: unexplained force reported'] == flagged
        assert found[f'{alone}{when}: an effect named'] == named
        assert found[f'{beside}{when}: both reported'] == both
    lines = {line[0]: line[2:6] for line in build_outside_table(cases).rows}
    assert lines == {
        'tether': ['early', '3', '3', '0'],
        'leash': ['late', '1', '1', '0'],
        'tray': ['late', '1', '0', '1'],
    }
    report = build_report([scored(cases)], [Path('somewhere')])
    assert [tile.value for tile in report.tiles] == ['1/1', '0/1', '0/0', '4/5', '1/2', '3/3']
    refused = [replace(each, refused='too short') for each in cases[:2]]
    assert format_headline(refused + cases[2:]) == (
        'Discovery results for 8 cases with hidden effects, 2 of them refused'
    )


ABOUT = {
    'registry': 'abc', 'vehicle': 'gtmab', 'vehicle_digest': 'def', 'commit': 'c0ffee',
    'row': 'base', 'kind': '', 'seed': 1, 'cases': 8, 'scored': 1, 'seconds': [60.0, 180.0],
}  # fmt: skip


def scored(cases: list[ScoredCase], **about: object) -> ChallengeScore:
    return ChallengeScore({**ABOUT, **about}, tuple(cases))


def test_the_page_says_what_it_scored() -> None:
    cases = [case({'motor_lag': 0.1}, {'linear_drag.surge': 0.03})]
    text = format_markdown_page([scored(cases)])
    assert 'effects `abc`, vehicle `gtmab` `def`, commit `c0ffee`.' in text
    row = '| one hidden effect: a wrong one named | 1/1 = 100 % (21 to 100) | <= 2 % | no |'
    assert row in text
    assert '| 0 | base | single | motor_lag (10.0) | linear_drag.surge |' in text
    assert '## All rows' not in text


def test_a_page_has_the_challenges_of_a_row_together_and_the_rows_side_by_side() -> None:
    wrong = [case({'motor_lag': 0.1}, {'linear_drag.surge': 0.03})]
    clean = [case({}, {}, kind='clean', verdict='none')] * 3
    other = scored(clean, kind='clean', seed=7, scored=3, commit='c0ffee, decaf')
    text = format_markdown_page([scored(wrong, row='pose'), scored(wrong), other])
    assert 'commit `c0ffee`, `decaf`.' in text
    assert '| figure | target | base | pose |' in text
    assert '| cases |  | 4 | 1 |' in text
    dash = '\N{EN DASH}'
    assert f'| no hidden effect: an effect named | <= 1 % | 0/3 = 0 % | {dash} |' in text
    assert '| one hidden effect: a wrong one named | <= 2 % | 1/1 = 100 % | 1/1 = 100 % |' in text
    heads = [line for line in text.splitlines() if line.startswith('## ')]
    assert [head.split(':')[0] for head in heads] == ['## All rows', '## Base', '## Pose']
    assert (
        '4 cases: 1 of all kinds (seed 1, flights of 60 to 180 s), '
        '3 clean (seed 7, flights of 60 to 180 s).'
    ) in text


def test_a_figure_that_a_row_lacks_is_a_dash_beside_the_others() -> None:
    """Laws are sought in one row alone."""
    outside = case({}, {}, kind='outside', outside='tether', verdict='unexplained')
    sought = scored([replace(outside, law=True)])
    text = format_markdown_page([sought, scored([outside], row='pose')])
    dash = '\N{EN DASH}'
    row = f'| effect outside the library: a law proposed |  | 1/1 = 100 % | {dash} |'
    assert row in text
    assert (
        f'| 95 % intervals that contain the true value | >= 90 %, <= 98 % | {dash} | {dash} |'
        in text
    )


def test_several_challenges_make_one_report_of_all_their_cases() -> None:
    wrong = scored([case({'motor_lag': 0.1}, {'linear_drag.surge': 0.03})], row='pose')
    clean = scored([case({}, {}, kind='clean', verdict='none')] * 3, seed=7)
    report = build_report([wrong, clean], [Path('a'), Path('b')])
    assert report.headline == 'Discovery results for 4 cases with hidden effects'
    assert report.facts['challenge'] == 'a, b'
    assert report.facts['seed'] == '1, 7'
    assert [len(each['cases']) for each in report.data] == [1, 3]
    assert 'All rows' in [each.heading for each in report.blocks]
    assert report.commands.keys() == {'make a again', 'make b again'}


def test_errors_are_compared_with_the_oracle_that_knows_the_equation() -> None:
    """The larger ratio of position and attitude; without a law, that of the model without."""
    oracle = [
        {'channel': channel, 'horizon_s': 3.0, 'before': 8.0 * best, 'tuned': tuned, 'after': best}
        for channel, best, tuned in (('position', 0.01, 0.03), ('attitude', 0.02, 0.05))
    ]
    with_law = [{**one, 'after': 1.2 * one['after']} for one in oracle]
    law = {'proposed': True, 'errors': with_law}
    answer = {
        'kind': 'outside', 'row': 'base', 'outside': 'magnet', 'floors': 9.0, 'hidden': [],
        'nominal': {'given': {}},
    }  # fmt: skip
    found = {
        'effects': [], 'verdict': 'unexplained', 'refused': '', 'cpu_s': 1.0, 'law': law,
        'oracle': {'law': oracle},
    }  # fmt: skip
    one = score_case(0, answer, found)
    assert one.law is True
    assert one.floors == 9.0
    assert score_case(0, {**answer, 'size': 12.0}, found).floors == 12.0
    assert one.oracle_ratios == pytest.approx({'before': 8.0, 'tuned': 3.0, 'law': 1.2})
    none = score_case(1, answer, {**found, 'law': {'proposed': False, 'errors': with_law}})
    assert none.oracle_ratios['law'] == pytest.approx(3.0)
    # Without a report there is neither a law nor an oracle
    silent = score_case(2, answer, {**found, 'verdict': 'none', 'law': None, 'oracle': {}})
    shares = {each.name: each.share for each in compute_score_figures([one, none, silent])}
    near = shares['effect outside the library, flagged: forecasts within 1.3 of the oracle']
    assert (near.hits, near.of) == (1, 2)
    proposed = shares['effect outside the library: a law proposed']
    assert (proposed.hits, proposed.of) == (1, 3)
    row = build_outside_table([one, none]).rows[0]
    assert row[-4:] == ['1', '8.00', '3.00', '2.10']
