# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Numbers of a mapping or a log that no time or value can be are refused in one sentence."""

import warnings

from lta_config.errors import BadInput
import numpy as np
import pytest

from .csv_texts import ODOM, POSE, text

TIME = '{column: t, unit: s}'
TIMES = ('rate: %s Hz', 'step: %s s', 'column: t, unit: ns, start: %s s', 'column: t, start: %s h')
FIELDS = (
    'scale: %s', 'over: %s', 'offset: %s', 'missing: %s', 'within: [%s, 9]', 'within: [0, %s]',
    'scale: [1, %s, 1]',
)  # fmt: skip
NUMBERS = (
    '1.0e-300', '5.0e-324', '-0.0', '0', '-1', '1.0e+300', '1.7e+308', '.inf', '-.inf', '.nan',
    '9' * 400, '-' + '9' * 30, '18446744073709551616', '2147483648', '1.0e+18', '[1]', 'null', 'a',
)  # fmt: skip
CELLS = (
    '1e300', '-1e300', '1e308', '1e999999', '1e999999999', 'inf', 'nan', '9' * 400, '9223372036',
    '9223372036854775807', '-9223372036854775808', '4e9', '-0.0', '1e-300',
)  # fmt: skip


@pytest.fixture
def attempt(bring, tmp_path):
    """Return what imports a log: it is read, or refused in one sentence, and no number warns."""
    source = text(tmp_path / 'a.csv', 't,x,y,z', '5,1,2,3', '6,1,2,3', '7,1,2,3')

    def run(mapping, source=source):
        with warnings.catch_warnings():
            warnings.simplefilter('error')
            try:
                return bring(source, mapping)
            except BadInput as told:
                sentence = str(told)
        assert '\n' not in sentence
        assert sentence.endswith('.')
        assert not (tmp_path / 'out').exists()
        return None

    return run


@pytest.mark.parametrize('number', NUMBERS)
@pytest.mark.parametrize('key', TIMES)
def test_the_time_of_a_mapping(attempt, key, number):
    got = attempt(POSE.replace(TIME, '{' + key.replace('%s', number) + '}'))
    if got is not None:
        assert all(0 <= stamp < 2**31 * 10**9 for stamp in got.stamps(ODOM))


@pytest.mark.parametrize('number', NUMBERS)
@pytest.mark.parametrize('key', FIELDS)
def test_a_field_of_a_mapping(attempt, key, number):
    attempt(POSE.replace('unit: m}', 'unit: m, ' + key.replace('%s', number) + '}'))


@pytest.mark.parametrize('cell', CELLS)
@pytest.mark.parametrize('unit', ['s', 'ns'])
def test_the_times_of_a_log(attempt, tmp_path, cell, unit):
    source = text(tmp_path / 'b.csv', 't,x,y,z', '5,1,2,3', f'{cell},1,2,3')
    attempt(POSE.replace('unit: s', f'unit: {unit}'), source)


@pytest.mark.parametrize('cell', [1e300, 1e18, -1e300, np.inf, np.nan, 2**63 - 1, -(2**63)])
@pytest.mark.parametrize('unit', ['s', 'ns'])
def test_the_times_of_an_array(attempt, tmp_path, cell, unit):
    np.savez(tmp_path / 'b.npz', t=np.array([5, cell]), **dict.fromkeys('xyz', np.ones(2)))
    mapping = POSE.replace('format: csv', 'format: numpy').replace('unit: s', f'unit: {unit}')
    assert 'numpy' in mapping
    attempt(mapping, tmp_path / 'b.npz')


@pytest.mark.parametrize(
    ('time', 'sentence'),
    [
        ('rate: 1.0e-300 Hz', 'has rows that are 1e+300 s apart; give a rate with 1e-09 s to'),
        ('step: 1.0e-10 s', 'has rows that are 1e-10 s apart; give a step with 1e-09 s to'),
        ('column: t, start: 1.0e300 s', 'has a start at 1e+300 s; a ROS time stamp is below'),
    ],
)
def test_the_sentence_names_the_number(bring, tmp_path, time, sentence):
    source = text(tmp_path / 'a.csv', 't,x,y,z', '5,1,2,3')
    with pytest.raises(BadInput, match=sentence.replace('+', r'\+')):
        bring(source, POSE.replace(TIME, '{' + time + '}'))


def test_rows_that_end_beyond_all_stamps(bring, tmp_path):
    source = text(tmp_path / 'a.csv', 't,x,y,z', *(4 * ['5,1,2,3']))
    with pytest.raises(BadInput, match=r'Row 4 is at 6e\+09 s, outside the range'):
        bring(source, POSE.replace(TIME, '{step: 2.0e9 s}'))


def test_a_value_too_large_for_a_float(bring, tmp_path):
    source = text(tmp_path / 'a.csv', 't,x,y,z', '5,1,2,3', '6,1,200,3')
    with pytest.raises(BadInput, match=r"^Column 'y' has 200 in row 2, which is too large with"):
        bring(source, POSE.replace('unit: m}', 'unit: m, scale: 1.0e+306}'))
