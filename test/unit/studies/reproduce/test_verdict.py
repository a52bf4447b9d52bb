# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Verdicts of the reproduction, and how its values are told and kept."""

import math

from kept_figures import kepts_in
from lta_config.errors import BadInput
from lta_config.files import validate_content
from lta_config.quantity import Quantity
from lta_config.schema.paper_file import AgreementRule, load_paper_rows, PaperMeasure, PaperRow
from lta_report.report import TextTable
from lta_report.study_store import StudyStore
from lta_studies.reproduce import study_result
from lta_studies.reproduce.report import (
    build_claim_table,
    format_headline,
    list_claim_findings,
    to_json,
)
from lta_studies.reproduce.run import ROW_STORE, STUDIES
from lta_studies.reproduce.study_result import (
    DrawSummary,
    is_satisfied,
    MeasuredValue,
    summarize_draws,
)
from lta_studies.reproduce.verdict import (
    ClaimVerdict,
    format_draws,
    format_value,
    judge_claim,
)
from plotly.graph_objects import Figure
import pytest


def quantity(text):
    return Quantity.model_validate(text)


CONTENT = {
    'schema': 1, 'name': 'row', 'number': 1, 'title': 'Row', 'scenario': 'none',
    'measures': {
        'path': {'what': 'path', 'unit': 'm', 'digits': 1},
        'first': {'what': 'who is first'},
    },
    'claims': {
        'path': {'says': 'The path is 7.3 m.', 'where': 'x', 'source': 'printed',
                 'value': '7.3 m', 'measure': 'path', 'rule': {'within': '10 %'},
                 'finding': 'It took {path}.', 'gap': 'By {first}.'},
        'first': {'says': 'BAG is first.', 'where': 'x', 'source': 'read',
                  'measure': 'first', 'rule': {'is': 'BAG'}},
        'cfd': {'says': 'A pressure.', 'where': 'x', 'source': 'comment',
                'untested': 'No wind tunnel.'},
    },
}  # fmt: skip
ROW = validate_content(PaperRow, CONTENT, 'row')


@pytest.mark.parametrize(
    ('rule', 'value', 'kept'),
    [
        ({'within': '10 %'}, 8.02, True),
        ({'within': '10 %'}, 8.04, False),
        ({'within': '10 %'}, 6.57, True),  # the very bound, which no decimal is
        ({'least': '7 m'}, 7.0, True),
        ({'least': '7 m', 'most': '8 m'}, 8.1, False),
        ({'most': '8 m'}, math.nan, False),
        ({'is': 'yes'}, 'yes', True),
        ({'is': 'yes'}, 'no', False),
    ],
)
def test_a_rule_holds_or_not(rule, value, kept):
    read = AgreementRule.model_validate(
        {key: word if key == 'is' else quantity(word) for key, word in rule.items()}
    )
    assert is_satisfied(read, quantity('7.3 m'), value) is kept


def stored(draws=None, **values):
    return study_result.StoredRow(
        {name: MeasuredValue(value) for name, value in values.items()}, [], [], 1, 0.0, draws or {}
    )


def test_a_claim_agrees_differs_is_untested_or_left_out():
    found = stored(path=9.0)
    assert [judge_claim(name, claim, found) for name, claim in ROW.claims.items()] == [
        ClaimVerdict.DIFFERS, ClaimVerdict.LEFT_OUT, ClaimVerdict.UNTESTED,
    ]  # fmt: skip
    assert judge_claim('path', ROW.claims['path'], stored(path=7.2)) is ClaimVerdict.AGREES


def test_a_verdict_needs_nearly_all_draws():
    claim = ROW.claims['path']

    def judge(agreeing, drawn=200):
        draws = {'path': {'path': DrawSummary(drawn, agreeing / drawn, 7.3, 7.0, 7.6)}}
        # The value of the file itself agrees, and does not count where draws are
        return judge_claim('path', claim, stored(draws, path=7.3))

    # Wilson's interval of 197 in 200 begins at 95.7 %, that of 196 at 94.97 %
    assert judge(197) is ClaimVerdict.AGREES
    assert judge(196) is ClaimVerdict.NUMBERS
    assert judge(4) is ClaimVerdict.NUMBERS
    assert judge(3) is ClaimVerdict.DIFFERS
    # Of 20 draws even all do not suffice: the interval begins at 84 %
    assert judge(20, 20) is ClaimVerdict.NUMBERS


def test_a_rate_is_shown_by_few_failures_of_single_flights():
    content = {'says': 'It arrives.', 'where': 'x', 'source': 'read', 'measure': 'share',
               'rule': {'least': '50 %'}, 'flights': 'rate'}  # fmt: skip
    measures = {'share': {'what': 'share', 'unit': '%'}}

    def judge(arrived, **changed):
        claims = {'share': {**content, **changed}}
        row = validate_content(
            PaperRow, {**CONTENT, 'measures': measures, 'claims': claims}, 'row'
        )
        draws = {'share': {'share': DrawSummary(200, arrived / 200, 1.0, 1.0, 1.0)}}
        return judge_claim('share', row.claims['share'], stored(draws, share=1.0))

    # Half of the draws with a rate below 50 % fail at least: 2 x 1.9 % of 200 may, at 95 %
    assert judge(200) is ClaimVerdict.AGREES
    assert judge(199) is ClaimVerdict.CHANCE
    assert judge(100) is ClaimVerdict.CHANCE
    assert judge(0) is ClaimVerdict.DIFFERS
    # Up to 80 % a fifth of the flights fails at most, which 200 flights do not show
    assert judge(200, rule={'least': '80 %'}) is ClaimVerdict.CHANCE
    # A rate that is bounded above is shown by flights that do not arrive
    assert judge(200, rule={'most': '50 %'}) is ClaimVerdict.AGREES
    with pytest.raises(BadInput, match='either "least" or "most"'):
        judge(200, rule={'within': '20 %'}, value='50 %')


def test_a_printed_flight_differs_outside_of_nine_of_ten_flights_alone():
    claim = ROW.claims['path'].model_copy(update={'flights': 'single'})

    def judge(low, high, share=0.0):
        draws = {'path': {'path': DrawSummary(200, share, low, low, high, 90)}}
        return judge_claim('path', claim, stored(draws, path=7.3))

    # 7.3 m are printed
    assert judge(7.0, 48.0) is ClaimVerdict.CHANCE
    assert judge(13.0, 21.0) is ClaimVerdict.DIFFERS
    assert judge(7.0, 7.6, 1.0) is ClaimVerdict.AGREES
    assert judge(math.nan, math.nan) is ClaimVerdict.DIFFERS
    drawn = {'path': {'path': DrawSummary(200, 0.04, 9.0, 7.8, 48.1, 120)}}
    assert format_draws(ROW, 'path', stored(drawn, path=7.3)) == (
        '7.8 to 48.1 m, 4 % of 200 agree, 120 did not arrive'
    )


def test_what_was_not_drawn_needs_its_whole_interval():
    claim = ROW.claims['path']

    def judge(*value):
        values = {'path': MeasuredValue(*value)}
        return judge_claim('path', claim, study_result.StoredRow(values, [], [], 1, 0.0))

    # 6.57 to 8.03 m agree
    assert judge(7.3, 7.0, 8.0) is ClaimVerdict.AGREES
    assert judge(7.3, 7.0, 9.0) is ClaimVerdict.CHANCE
    assert judge(9.3, 9.0, 9.6) is ClaimVerdict.DIFFERS
    assert judge(7.3) is ClaimVerdict.AGREES
    claim = claim.model_copy(update={'flights': 'single'})
    assert judge(7.3) is ClaimVerdict.CHANCE


def test_a_verdict_needs_all_readings():
    content = {**CONTENT['claims']['path'], 'reading': 'as flown', 'readings': {'as read': 'way'}}
    measures = {**CONTENT['measures'], 'way': {'what': 'way', 'unit': 'm', 'digits': 1}}
    row = validate_content(
        PaperRow, {**CONTENT, 'measures': measures, 'claims': {'path': content}}, 'row'
    )
    claim = row.claims['path']
    assert judge_claim('path', claim, stored(path=7.2, way=7.4)) is ClaimVerdict.AGREES
    assert judge_claim('path', claim, stored(path=7.2, way=9.4)) is ClaimVerdict.READING
    assert judge_claim('path', claim, stored(path=9.2, way=9.4)) is ClaimVerdict.DIFFERS
    # --quick may leave a reading out
    assert judge_claim('path', claim, stored(path=7.2)) is ClaimVerdict.AGREES
    assert format_draws(row, 'path', stored(path=7.2, way=9.4)) == (
        'as flown: 7.2 m; as read: 9.4 m'
    )
    drawn = {'path': {'path': DrawSummary(200, 0.63, 7.3, 6.9, 9.5)}}
    assert format_draws(row, 'path', stored(drawn, path=7.2)) == (
        'as flown: 6.9 to 9.5 m, 63 % of 200 agree'
    )


def test_agreement_that_could_not_fail_is_counted_apart():
    claim = ROW.claims['path']
    held = claim.model_copy(update={'construction': 'It was chosen so.'})
    assert judge_claim('path', held, stored(path=7.2)) is ClaimVerdict.CONSTRUCTION
    assert judge_claim('path', held, stored(path=9.2)) is ClaimVerdict.DIFFERS
    empty = claim.model_copy(update={'vacuous': 'first'})
    assert judge_claim('path', empty, stored(path=7.2, first='yes')) is ClaimVerdict.VACUOUS
    assert judge_claim('path', empty, stored(path=7.2, first='no')) is ClaimVerdict.AGREES


def test_draws_are_summed_up_by_their_quantiles_and_the_share_that_agrees():
    rule = AgreementRule.model_validate({'most': quantity('2 m')})
    found = summarize_draws(rule, None, [1.0, 2.0, 3.0, math.nan])
    assert (found.drawn, found.share, found.middle, found.missing) == (4, 0.5, 2.0, 1)
    assert (found.low, found.high) == (pytest.approx(1.1), pytest.approx(2.9))
    word = summarize_draws(AgreementRule.model_validate({'is': 'a'}), None, ['a', 'b', 'b'])
    assert (word.share, word.middle) == (pytest.approx(1 / 3), 'b')
    assert math.isnan(summarize_draws(rule, None, [math.nan]).middle)


def test_values_are_told_rounded_as_declared_with_their_interval():
    metres = PaperMeasure(what='path', unit='cm', digits=0)
    assert format_value(metres, MeasuredValue(0.0712, 0.05, 0.09, 3)) == '7 (5 to 9) cm'
    assert format_value(metres, MeasuredValue(0.0712, 0.0711, 0.0713, 3)) == '7 cm'
    assert format_value(metres, MeasuredValue(math.nan)) == 'never'
    assert format_value(metres, None) == '\N{EN DASH}'
    tilt = PaperMeasure(what='tilt', unit='deg', digits=1)
    assert format_value(tilt, MeasuredValue(-math.radians(2.04))) == '\N{MINUS SIGN}2.0°'


def test_a_gap_is_told_where_a_claim_differs_alone():
    def told_of(path):
        found = {'path': MeasuredValue(path), 'first': MeasuredValue('BAG')}
        return list_claim_findings(ROW, study_result.StoredRow(found, [], [], 1, 0.0))

    # The second claim agrees and has no remark; the third says why it cannot be tested
    untested = '*A pressure.* No wind tunnel.'
    assert told_of(9.0) == ['*The path is 7.3 m.* It took 9.0 m. **By BAG.**', untested]
    assert told_of(7.0) == ['*The path is 7.3 m.* It took 7.0 m.', untested]


def test_each_claim_has_a_row_with_its_verdict():
    found = {'path': MeasuredValue(9.0, 8.5, 9.5, 3)}
    table = build_claim_table(ROW, study_result.StoredRow(found, [], [], 3, 0.0))
    dash = '\N{EN DASH}'
    assert table.rows == [
        [
            'The path is 7.3 m.',
            'x',
            '7.3 m',
            'within 10 %',
            '9.0 (8.5 to 9.5) m',
            '3',
            dash,
            'differs',
        ],
        [
            'BAG is first.',
            'x (read from text)',
            dash,
            'is BAG',
            dash,
            dash,
            dash,
            'not measured in this run',
        ],
        ['A pressure.', 'x (LaTeX comment)', dash, dash, dash, dash, dash, 'cannot be tested'],
    ]
    assert [table.colors[row[-1]] for row in table.rows] == ['bad', 'soft', 'soft']


def test_a_row_is_stored_whole(tmp_path):
    values = {'path': MeasuredValue(7.0, seeds=2), 'first': MeasuredValue('BAG')}
    picture = study_result.StudyPicture('path', 'Path', 'The path.', Figure(), 'lta fly')
    row = study_result.StoredRow(values, [picture], [TextTable('T', ['a'], [['b']])], 2, 1.5)
    with StudyStore(tmp_path, ROW_STORE, 'rows') as store:
        store.add('row', row)
    with StudyStore(tmp_path, ROW_STORE, 'rows') as store:
        assert repr(store.results['row']) == repr(row)


def test_a_changed_row_file_or_effort_is_another_row():
    names = {
        study_result.hash_row(ROW, 1, True, 'code'),
        study_result.hash_row(ROW, 2, True, 'code'),
        study_result.hash_row(ROW, 1, False, 'code'),
        study_result.hash_row(ROW, 1, True, 'other'),
        study_result.hash_row(ROW.model_copy(update={'title': 'Other'}), 1, True, 'code'),
    }
    assert len(names) == 5


def test_every_row_has_a_study_and_every_study_a_row():
    rows = load_paper_rows()
    assert set(STUDIES) == {row.name for row in rows}
    numbers = [row.number for row in rows]
    assert numbers == sorted(set(numbers))


def test_nothing_is_told_of_a_measure_that_was_left_out():
    assert list_claim_findings(ROW, stored(first='BAG')) == ['*A pressure.* No wind tunnel.']


def test_figures_come_back_from_their_file():
    values = {'path': MeasuredValue(9.0, 8.0, math.inf, 3), 'first': MeasuredValue('DGA')}
    drawn = study_result.StudyPicture('way', 'The way', 'From above.', Figure(), 'lta simulate')
    draws = {'path': {'path': DrawSummary(200, 0.25, 9.0)}}
    found = {'row': study_result.StoredRow(values, [drawn], [], 3, 2.04, draws)}
    again = kepts_in(to_json([ROW], found))['row']
    assert again.values['path'][:2] == (9.0, 8.0)
    assert math.isnan(again.values['path'].high)
    assert again.values['first'].value == 'DGA'
    assert again.pictures == [drawn]
    assert (again.seeds, again.seconds) == (3, 2.0)
    assert again.draws['path']['path'][:3] == (200, 0.25, 9.0)
    assert math.isnan(again.draws['path']['path'].low)


def test_a_row_that_was_not_drawn_yet_says_so():
    row = validate_content(PaperRow, {**CONTENT, 'draws': {'quick': 2, 'full': 200}}, 'row')
    found = {'row': stored(path=7.0, first='BAG')}
    assert format_headline([row], found).endswith(
        'Row 1 was not drawn yet: its verdicts are preliminary.'
    )
    drawn = {'path': {'path': DrawSummary(200, 1.0, 7.0, 6.9, 7.1)}}
    assert 'preliminary' not in format_headline([row], {'row': stored(drawn, path=7.0)})
    # A row without ranges needs no draws
    assert 'preliminary' not in format_headline([ROW], found)
