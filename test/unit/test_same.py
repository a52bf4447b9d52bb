# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`make same`: which numbers of a result it keeps, and what it calls different."""

from pathlib import Path
import sys

SAME = Path(__file__).resolve().parents[1] / 'same'
sys.path.append(str(SAME))

from commands import list_numbers, LONGEST, read_tables, shorten  # noqa: E402
from same import list_differences, read_table, write_table  # noqa: E402


def test_numbers_of_json_stand_under_their_paths():
    found = {'name': 'gtmab', 'mass': 0.1, 'ok': True, 'path': [1, 2.5], 'rows': [{'t': 3}]}
    assert dict(list_numbers(found)) == {
        'mass': '0.1',
        'ok': 'True',
        'path': '1 2.5',
        'rows.0.t': '3',
    }


def test_a_long_list_is_one_row_that_any_number_changes():
    rows = [{'t': k} for k in range(100)]
    ((name, before),) = list_numbers({'rows': rows})
    rows[99]['t'] = 100
    ((_, after),) = list_numbers({'rows': rows})
    assert name == 'rows'
    assert before[:LONGEST] == after[:LONGEST]
    assert before != after


def test_a_page_gives_the_numbers_of_its_cells(tmp_path):
    page = tmp_path / 'page.html'
    page.write_text(
        '<p>7</p><table><tr><th>mass in 3D</th><td>\N{MINUS SIGN}1.5 <b>g</b></td></tr></table>'
        '<table><tr><td>2e-3</td><td>x2</td></tr></table>'
    )
    tables = dict(read_tables(page))
    assert tables == {
        'page.html table 1': '\N{MINUS SIGN}1.5',
        'page.html table 2': '2e-3',
    }
    assert shorten('1 2') == '1 2'


def test_differences_are_rows_that_changed_or_went(tmp_path):
    write_table(tmp_path / 'a.csv', {'b, c': '1', 'a': '2', 'gone': '3'})
    frozen = read_table(tmp_path / 'a.csv')
    assert frozen == {'a': '2', 'b, c': '1', 'gone': '3'}
    assert list_differences(frozen, {'a': '2', 'b, c': '4', 'new': '5'}) == [
        'b, c: 1 -> 4',
        'gone: 3 -> nothing',
    ]
