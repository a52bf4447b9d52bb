# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Times of a text with columns: every nanosecond, dates, and what is no time."""

from datetime import datetime

from hypothesis import given
from hypothesis import strategies as st
from lta_config.errors import BadInput
from lta_data.importers.readers.column_log import parse_exact_times
import numpy as np
import pytest

from .csv_texts import ODOM, POSE, text


def test_rows_keep_the_order_of_the_file(bring, tmp_path):
    """Two topics of a row come one after the other, also where the time goes back."""
    mapping = POSE + '  - topic: range\n    range: {column: h, unit: mm}\n'
    source = text(tmp_path / 'a.csv', 't,x,y,z,h', '9,1,2,3,4', '8,1,2,3,', '7,1,2,3,5')
    found = bring(source, mapping)
    from lta_bag.reader import read_bag

    met = [(topic, time) for topic, time, _ in read_bag(found.imported.bag).iterate_messages()]
    second = 1_000_000_000
    assert met == [
        (ODOM, 9 * second),
        ('/lta1/range', 9 * second),
        (ODOM, 8 * second),
        (ODOM, 7 * second),
        ('/lta1/range', 7 * second),
    ]


@pytest.mark.parametrize(
    ('time', 'expected'),
    [
        ('time: {rate: 60 Hz}', [1_000_000_000, 1_016_666_667, 1_033_333_333]),
        ('time: {step: 5 ms}', [1_000_000_000, 1_005_000_000, 1_010_000_000]),
        (
            'time: {rate: 50 Hz, start: 100 s}',
            [100_000_000_000 + k * 20_000_000 for k in range(3)],
        ),
        ('time: {column: t}', [1_500_000_000, 1_600_000_000, 2_700_000_000]),
        ('time: {column: t, start: 10 s}', [10_500_000_000, 10_600_000_000, 11_700_000_000]),
    ],
)
def test_times_that_are_missing_or_begin_at_zero(bring, tmp_path, time, expected):
    source = text(tmp_path / 'a.csv', 't,x,y,z', '0.5,1,2,3', '0.6,1,2,3', '1.7,1,2,3')
    found = bring(source, POSE.replace('time: {column: t, unit: s}', time))
    assert found.stamps(ODOM) == expected
    assert ('1 s were added to all times' in found.notes) == ('start' not in time)


@given(st.integers(0, 2**31 - 1), st.integers(0, 999_999_999))
def test_a_time_keeps_every_nanosecond(seconds, nanoseconds):
    texts = [f'{seconds}.{nanoseconds:09d}', str(seconds * 10**9 + nanoseconds)]
    whole = seconds * 10**9 + nanoseconds
    assert parse_exact_times(texts[:1], 's', 't').times.tolist() == [whole]
    assert parse_exact_times(texts[1:], 'ns', 't').times.tolist() == [whole]


DATES = {
    'zulu': (('2026-11-20T13:25:48Z', '2026-11-20T13:25:48.123456789Z'), 123_456_789),
    'offset': (('2026-11-20T15:25:48+02:00', '2026-11-20T15:25:48.5+0200'), 500_000_000),
    'blank': (('2026-11-20 13:25:48', '2026-11-20 13:25:48,000001'), 1_000),
    'basic': (('20261120T132548Z', '20261120T132548.25Z'), 250_000_000),
    'European': (('20.11.2026 13:25:48', '20.11.2026 13:25:48,5'), 500_000_000),
    'day first': (('20/11/2026 13:25:48', '20/11/2026 13:25:48.5'), 500_000_000),
    'American': (('11/20/2026 1:25:48 PM', '11/20/2026 1:25:48.5 PM'), 500_000_000),
    'year first': (('2026/11/20 13:25:48', '2026/11/20 13:25:48.5'), 500_000_000),
}


@pytest.mark.parametrize('case', DATES)
def test_dates_are_times_to_the_last_digit(bring, tmp_path, case):
    times, fraction = DATES[case]
    source = text(tmp_path / 'a.csv', 't;x;y;z', *(f'{time};1;2;3' for time in times))
    found = bring(source, POSE.replace('format: csv', 'format: csv\ntext: {delimiter: ";"}'))
    start = 1_795_181_148 * 10**9  # date -u -d '2026-11-20 13:25:48' +%s
    assert found.stamps(ODOM) == [start, start + fraction]
    assert ('UTC is assumed' in found.notes) == ('Z' not in times[0] and '+' not in times[0])


@pytest.mark.parametrize('texts', [
    ('0 days 00:01:02.25', '0 days 00:01:03'), ('1:02.25', '1:03.0'),
    ('62.25 sec', '63 sec'), ('1.0375 min', '1.05 min'),
])  # fmt: skip
def test_what_has_passed_is_a_time(texts):
    assert parse_exact_times([*texts], 's', 't').times.tolist() == [62_250_000_000, 63 * 10**9]


def test_a_month_that_comes_first_is_told_by_the_day_of_a_later_row():
    times = parse_exact_times(['05/12/2026 23:59:59', '05/13/2026 00:00:00'], 's', 't')
    assert np.diff(times.times).tolist() == [10**9]
    assert 'are read as month and day' in ' '.join(times.assumed)


@pytest.mark.parametrize('texts', [
    # A number above 12 is a day, whatever AM and PM say
    ('13/11/2026 1:25:48 PM', '13/11/2026 1:25:49 PM'),
    # Without one, midnight is no leap by a month
    ('5/11/2026 11:59:59 PM', '6/11/2026 12:00:00 AM'),
    ('5/11/2026 23:59:59', '6/11/2026 00:00:00'),
    ('11/5/2026 11:59:59 p.m.', '11/6/2026 12:00:00 a.m.'),
    ('1/2/2026 1:25:48 p.m.', '1/2/2026 1:25:49 p.m.'),
    ('59:59.5', '60:00.5'), ('59:59.9', '1:00:00.9'), ('59.9 s', '1:00.9'),
    ('23:59:59.5', '24:00:00.5'), ('100:59.9', '6060.9 sec'),
])  # fmt: skip
def test_a_second_passes_over_midnight_and_the_full_hour(texts: tuple[str, str]) -> None:
    times = parse_exact_times([*texts], 's', 't').times
    assert np.diff(times).tolist() == [10**9]


@pytest.mark.parametrize(('text', 'iso'), [
    ('1/2/2026 1:25:48 p.m.', '2026-01-02T13:25:48'),  # on one day, as Americans write
    ('1/2/2026 13:25:48', '2026-02-01T13:25:48'),
    ('13/11/2026 12:25:48 AM', '2026-11-13T00:25:48'),
    ('20261120T132548.5-0130', '2026-11-20T13:25:48.5-01:30'),
    ('2026-11-20 13:25:48+0545', '2026-11-20T13:25:48+05:45'),
])  # fmt: skip
def test_a_date_is_that_of_the_calendar(text: str, iso: str) -> None:
    expected = datetime.fromisoformat(iso if iso[-6] in '+-' else f'{iso}+00:00').timestamp()
    assert parse_exact_times([text], 's', 't').times.tolist() == [round(1e9 * expected)]


@pytest.mark.parametrize(
    ('times', 'sentence'),
    [
        (('2026-11-20T13:25:48Z', '12.5'), "Column 't' has '12.5' in row 2, which is not a time"),
        (('12.5', '2026-11-20T13:25:48Z'), "'2026-11-20T13:25:48Z' in row 2, which is not a time"),
        (('2026-11-20T24:25:48Z',), "'2026-11-20T24:25:48Z' in row 1, which is not a time"),
        (('2026-02-30T13:25:48Z',), "'2026-02-30T13:25:48Z' in row 1, which is not a time"),
    ],
)
def test_what_is_no_time_is_named_with_its_row(bring, tmp_path, times, sentence):
    source = text(tmp_path / 'a.csv', 't,x,y,z', *(f'{time},1,2,3' for time in times))
    with pytest.raises(BadInput) as told:
        bring(source, POSE)
    assert sentence in str(told.value)
