# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is wrong in a text with columns, or in its mapping, is one sentence."""

import gzip
from pathlib import Path

from lta_config.errors import BadInput
from lta_data.importers.readers import csv_text
from lta_data.importers.readers.text_dialect import detect_text_format
import pytest

from .csv_texts import ODOM, POSE, text

WRONG = {
    'missing column': (('t,x,y', '5,1,2'), "has no column 'z'; it has t, x, y"),
    'no time column': (('x,y,z', '1,2,3'), "has no column 't'; it has x, y, z"),
    'not a number': (('t,x,y,z', '5,1,2,3', '6,1,oops,3'), "'oops' in column 'y', row 2"),
    'comma as point': (('t,x,y,z', '5,"1,5",2,3'), "'1,5' in column 'x', row 1"),
    'no time': (('t,x,y,z', '5,1,2,3', ',1,2,3'), "Column 't' has nothing in row 2"),
    'wrong time': (('t,x,y,z', '5 o,1,2,3'), "Column 't' has '5 o' in row 1"),
    'other delimiter': (('t,x,y,z', '5;1;2;3', '6;1;2;3'), 'have another number of cells'),
    'only names': (('t,x,y,z',), 'but no rows'),
    'too late': (('t,x,y,z', '5e9,1,2,3'), 'outside the range of ROS time stamps'),
    'too early': (('t,x,y,z', '5,1,2,3', '-6,1,2,3'), 'Row 2 of'),
}


@pytest.mark.parametrize(('lines', 'sentence'), WRONG.values(), ids=WRONG)
def test_what_is_wrong_in_a_text_is_one_sentence(bring, tmp_path, lines, sentence):
    source = text(tmp_path / 'a.csv', *lines)
    with pytest.raises(BadInput) as told:
        bring(source, POSE)
    assert sentence in str(told.value)
    assert '\n' not in str(told.value)
    assert {path.name for path in tmp_path.iterdir()} == {'a.csv', 'mapping.yaml'}


def test_a_text_that_unpacks_to_more_than_a_log_may_have_is_refused(bring, tmp_path, monkeypatch):
    monkeypatch.setattr(csv_text, 'LOG_BYTES', 1000)
    source = tmp_path / 'a.csv.gz'
    rows = ''.join(f'{k},1,2,3\n' for k in range(5, 500))
    source.write_bytes(gzip.compress(f't,x,y,z\n{rows}'.encode()))
    with pytest.raises(BadInput, match='unpacks to more than 1000 bytes'):
        bring(source, POSE)


def test_a_cut_compressed_text_is_refused(bring, tmp_path):
    lines = '\n'.join(f'{k},1,2,3' for k in range(5, 50_000))
    source = tmp_path / 'a.csv.gz'
    source.write_bytes(gzip.compress(f't,x,y,z\n{lines}\n'.encode())[:-2000])
    with pytest.raises(BadInput, match='compressed data are damaged or cut short'):
        bring(source, POSE)


MAPPINGS = {
    'dimension': ('unit: m}', 'unit: m/s}', 'position is in m/s, but must be in m'),
    'no unit': (', unit: m}', '}', 'position has no unit; add "unit: m"'),
    'unknown unit': ('unit: m}', 'unit: feet}', 'not a known unit'),
    'unknown topic': ('ground_truth/odom', 'odometry', "Unknown topic to import into 'odometry'"),
    'unknown part': (
        'position:',
        'pressure: {column: x}\n    position:',
        'known: orientation, position',
    ),
    'unknown key': ('position:', 'place:', 'not known'),
    'two times': ('unit: s}', 'unit: s, rate: 50 Hz}', 'exactly one of "column", "rate" and'),
    'no time': ('time: {column: t, unit: s}\n', '', 'needs the key "time"'),
    'time unit': ('unit: s}', 'unit: m}', 'must be in s, ms, us or ns'),
    'two columns': ('[x, y, z]', '[x, y]', 'must have 3 or more'),
    'axes': ('topics:', 'world: [x, x, z]\ntopics:', 'each once'),
    'named axes': ('topics:', 'world: DOWN\ntopics:', 'must be one of ENU'),
    'actuators': (
        'position:',
        'actuators: {m1: {}}\n    position:',
        "only the topic 'motors' can",
    ),
    'world velocity': (
        'position:',
        'velocity: {columns: [x, y, z], unit: m/s, frame: world}\n    position:',
        'give the orientation as well',
    ),
    'mirror': (
        'position:',
        'world: [x, -y, z]\n    orientation: {quaternion: [t, x, y, z]}\n    position:',
        'different handedness',
    ),
    'two attitudes': (
        'position:',
        'orientation: {euler: [x], sequence: Z, matrix: [x,x,x,x,x,x,x,x,x]}\n    position:',
        'needs exactly one of "quaternion"',
    ),
    'sequence': ('position:', 'orientation: {euler: [x, y]}\n    position:', 'has 2 columns'),
    'turns twice': (
        'position:',
        'orientation: {euler: [x, y], sequence: ZZ}\n    position:',
        'turns twice in a row about the same axis',
    ),
    'bounds': ('unit: m}', 'unit: m, within: [5, 9]}', "'x' has 1 in row 1"),
}


@pytest.mark.parametrize(('old', 'new', 'sentence'), MAPPINGS.values(), ids=MAPPINGS)
def test_what_is_wrong_in_a_mapping_is_one_sentence(bring, tmp_path, old, new, sentence):
    source = text(tmp_path / 'a.csv', 't,x,y,z', '5,1,2,3')
    assert old in POSE
    with pytest.raises(BadInput) as told:
        bring(source, POSE.replace(old, new, 1))
    assert sentence in str(told.value)
    assert '\n' not in str(told.value)
    assert not (Path(tmp_path) / 'out').exists()


def test_actuators_that_the_vehicle_does_not_have_are_named(bring, tmp_path):
    mapping = POSE + (
        '  - topic: motors\n'
        '    actuators:\n'
        '      left: {effort: {column: x, unit: N}}\n'
        '      moving_mass_x: {position: {column: y, unit: m}}\n'
        '      tail: {effort: {column: z}}\n'
    )
    found = bring(text(tmp_path / 'a.csv', 't,x,y,z', '5,1,2,3'), mapping, vehicle='rgblimp')
    assert (
        "Vehicle 'rgblimp' lacks these actuators of the log: tail; it has left, moving_mass_x"
        in found.notes
    )


def test_a_name_with_a_line_break_stays_on_one_line(bring, tmp_path):
    names = 't,x,y,"z\x1b[31m\nand more"'
    source = text(tmp_path / 'a.csv', names.replace('\n', '\r'), '1,2,3,4')
    with pytest.raises(BadInput) as told:
        bring(source, POSE)
    assert str(told.value).isprintable()


def test_a_remark_on_a_name_with_a_line_break_stays_on_one_line(bring, tmp_path):
    header = 'text: {header: [t, x, y, z, "one\\ntwo"]}\n'
    source = text(tmp_path / 'a.csv', '5,1,2,3,4')
    found = bring(source, POSE.replace('topics:', f'{header}topics:'))
    assert 'one two' in found.notes
    assert found.notes.isprintable()


def test_a_torn_line_names_once_more_and_mixed_separators_are_skipped_and_counted(bring, tmp_path):
    source = tmp_path / 'a.csv'
    lines = ['t,x,y,z', '5,1,2,3', '6;1;2;3', '7,1,2', 't,x,y,z', '8,4,5,6', '9,7,8,9', '10,1,2']
    source.write_text('\n'.join(lines))
    got = bring(source, POSE)
    assert [m.pose.pose.position.x for m in got.messages[ODOM]] == [1.0, 4.0, 7.0]
    assert got.stamps(ODOM) == [5_000_000_000, 8_000_000_000, 9_000_000_000]
    assert '2 rows have another number of cells than the names of the columns' in got.notes
    assert "the first as '6;1;2;3'" in got.notes
    assert 'The names of the columns are repeated once' in got.notes
    assert 'The last line is cut off and skipped.' in got.notes


@pytest.mark.parametrize(('last', 'rows'), [('9,7,8,9', 2), ('9,7,8,-', 1), ('9,7,8,1e', 1)])
def test_a_last_line_without_an_end_is_torn_only_if_it_lacks_something(
    bring, tmp_path, last, rows
):
    source = tmp_path / 'a.csv'
    source.write_text('t,x,y,z\n5,1,2,3\n' + last)
    got = bring(source, POSE)
    assert len(got.messages[ODOM]) == rows
    assert ('cut off' in got.notes) == (rows == 1)


def test_a_last_column_without_values_is_no_delimiter_at_the_end_of_rows(tmp_path):
    empty = text(tmp_path / 'a.csv', 't,x,y,u', '5,1,2,', '6,1,3,', '7,1,4,')
    assert detect_text_format(empty).header is None
    assert detect_text_format(empty).skip == 0
    ended = text(tmp_path / 'b.csv', 't,x,y', '5,1,2,', '6,1,3,', '7,1,4,')
    assert detect_text_format(ended).header is None
