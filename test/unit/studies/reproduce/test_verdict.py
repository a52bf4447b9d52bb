"""Verdicts of the reproduction, and how its values are told and kept."""

import math

from kept_figures import kepts_in
from lta_config.errors import BadInput
from lta_config.files import checked, known
from lta_config.quantity import Quantity
from lta_config.schema.paper_file import Measure, PaperRow, Rule
from lta_studies.reproduce import figures_file, kept, lines
from lta_studies.reproduce.found import over, Value
from lta_studies.reproduce.registry import STUDIES
from lta_studies.reproduce.run import rows_of
from lta_studies.reproduce.studies.indoors import misfit, PRINTED
from lta_studies.reproduce.verdict import holds, judge, told, Verdict
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
ROW = checked(PaperRow, CONTENT, 'row')


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
    read = Rule.model_validate(
        {key: word if key == 'is' else quantity(word) for key, word in rule.items()}
    )
    assert holds(read, quantity('7.3 m'), value) is kept


def test_a_claim_agrees_differs_is_untested_or_left_out():
    found = {'path': Value(9.0)}
    assert [judge(claim, found) for claim in ROW.claims.values()] == [
        Verdict.DIFFERS, Verdict.LEFT_OUT, Verdict.UNTESTED,
    ]  # fmt: skip
    assert judge(ROW.claims['path'], {'path': Value(7.2)}) is Verdict.AGREES


def test_values_are_told_rounded_as_declared_with_their_interval():
    metres = Measure(what='path', unit='cm', digits=0)
    assert told(metres, Value(0.0712, 0.05, 0.09, 3)) == '7 (5 to 9) cm'
    assert told(metres, Value(0.0712, 0.0711, 0.0713, 3)) == '7 cm'
    assert told(metres, Value(math.nan)) == 'never'
    assert told(metres, None) == '\N{EN DASH}'
    tilt = Measure(what='tilt', unit='deg', digits=1)
    assert told(tilt, Value(-math.radians(2.04))) == '\N{MINUS SIGN}2.0°'


def test_a_gap_is_told_where_a_claim_differs_alone():
    def told_of(path):
        found = {'path': Value(path), 'first': Value('BAG')}
        return lines.notes(ROW, kept.Kept(found, [], [], 1, 0.0))[0]

    assert told_of(9.0) == ('The path is 7.3 m.', 'It took 9.0 m.', 'By BAG.')
    assert told_of(7.0) == ('The path is 7.3 m.', 'It took 7.0 m.', '')


def test_means_have_students_interval():
    found = over([1.0, 2.0, 3.0])
    assert found.value == 2.0
    assert found.high == pytest.approx(2.0 + 4.302652729911275 / math.sqrt(3.0))
    assert math.isnan(over([1.0]).low)


def test_a_row_is_kept_whole_and_only_for_what_decides_it(tmp_path):
    place = tmp_path / 'rows' / 'row.json'
    found = kept.Kept({'path': Value(7.0, seeds=2), 'first': Value('BAG')}, [], [], 2, 1.5)
    kept.write(place, 'hash', found)
    again = kept.read(place, 'hash')
    assert again.values['first'].value == 'BAG'
    assert again.values['path'].seeds == 2
    assert math.isnan(again.values['path'].low)
    assert kept.read(place, 'another') is None
    place.write_text('{"identity": "ha')
    assert kept.read(place, 'hash') is None


def test_a_changed_row_file_or_effort_is_another_row():
    names = {
        kept.identity(ROW, 1, True, 'code'),
        kept.identity(ROW, 2, True, 'code'),
        kept.identity(ROW, 1, False, 'code'),
        kept.identity(ROW, 1, True, 'other'),
        kept.identity(ROW.model_copy(update={'title': 'Other'}), 1, True, 'code'),
    }
    assert len(names) == 5


def test_every_row_has_a_study_and_every_study_a_row():
    assert set(STUDIES) == set(known('paper'))


def test_an_unknown_row_is_one_sentence():
    with pytest.raises(BadInput, match='nobody'):
        rows_of(['nobody'])


def test_what_the_paper_leaves_for_later_is_no_claim_of_it():
    later = {'says': 'Wind.', 'where': 'x', 'source': 'future', 'measure': 'path'}
    row = checked(PaperRow, {**CONTENT, 'claims': {**CONTENT['claims'], 'later': later}}, 'row')
    assert judge(row.claims['later'], {'path': Value(1.0)}) is Verdict.BEYOND
    assert judge(row.claims['later'], {}) is Verdict.BEYOND
    found = {'row': kept.Kept({'path': Value(7.0), 'first': Value('BAG')}, [], [], 1, 0.0)}
    assert lines.title([row], found).startswith(
        "Of the paper's 3 claims, 2 agree, 0 differ and 1 "
    )
    later = {**later, 'rule': {'least': '7 m'}}
    with pytest.raises(BadInput, match='future'):
        checked(PaperRow, {**CONTENT, 'claims': {'later': later}}, 'row')


def test_nothing_is_told_of_a_measure_that_was_left_out():
    notes = lines.notes(ROW, kept.Kept({'first': Value('BAG')}, [], [], 1, 0.0))
    assert notes[0] == ('The path is 7.3 m.', '', '')


def test_figures_come_back_from_their_file():
    values = {'path': Value(9.0, 8.0, math.inf, 3), 'first': Value('DGA')}
    drawn = kept.Drawn('way', 'The way', 'From above.', '{}', 'lta simulate', 'bags/way')
    found = {'row': kept.Kept(values, [drawn], [], 3, 2.04)}
    again = kepts_in(figures_file.content([ROW], found))['row']
    assert again.values['path'][:2] == (9.0, 8.0)
    assert math.isnan(again.values['path'].high)
    assert again.values['first'].value == 'DGA'
    assert again.pictures == [drawn._replace(figure='')]
    assert (again.seeds, again.seconds) == (3, 2.0)


def test_a_cause_is_told_with_what_sized_it_and_not_where_that_was_left_out():
    series = {'one': {'figure': 'Fig. 1', 'printed': 'a path', 'said': 'It takes {path}.'}}
    row = checked(PaperRow, {**CONTENT, 'series': series}, 'row')
    found = kept.Kept({'path': Value(7.04)}, [], [], 1, 0.0)
    assert lines.series([row], {'row': found}) == [['1', 'Fig. 1', 'a path', 'It takes 7.0 m.']]
    assert lines.series([row], {'row': kept.Kept({}, [], [], 1, 0.0)})[0][3] == '\N{EN DASH}'
    wrong = {**CONTENT, 'series': {'one': {**series['one'], 'said': 'It takes {pth}.'}}}
    with pytest.raises(BadInput, match='which it does not measure'):
        checked(PaperRow, wrong, 'row')


def test_a_misfit_is_the_rms_of_logarithms_as_a_factor():
    twice = {name: Value(2.0 * printed) for name, printed in PRINTED.items()}
    assert misfit(twice, '') == pytest.approx(1.0)
    # One of five right: the others' logarithms weigh four fifths in the mean square.
    mended = {**twice, 'fast_bag_time': Value(PRINTED['bag_time'])}
    assert misfit(mended, 'fast_') == pytest.approx(2.0 ** math.sqrt(0.8) - 1.0)
