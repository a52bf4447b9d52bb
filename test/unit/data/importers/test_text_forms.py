# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Texts as spreadsheets, loggers and ros2 write them give the numbers that are in them."""

from lta_config.errors import BadInput
from lta_data.importers.draft.draft_mapping import draft_mapping
from lta_data.importers.readers.csv_text import detect_encoding
from lta_data.importers.readers.sensor_folder import read_text_file
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .lab_flights import lab_flight

NAMES = ('t', 'x', 'y', 'z', 'qx', 'qy', 'qz', 'qw')
LINES = 40


def rows(f):
    """Return lists of time, place and quaternion."""
    return np.column_stack([f['t'], f['p'], f['q']])[:LINES].round(6).tolist()


def comma(value):
    return f'{value:.6f}'.replace('.', ',')


def write_echo(f):
    """Return what `ros2 topic echo --csv` prints of a PoseStamped."""
    return '\n'.join(
        f'{1_700_000_000 + int(t)},{round(t % 1 * 1e9)},map,' + ','.join(map(str, pose))
        for t, *pose in rows(f)
    )


FORMS = {
    'commas in quoted names': lambda f: '\n'.join(
        ['"t, s","x, m","y, m","z, m",' + ','.join(NAMES[4:])]
        + [','.join(map(str, row)) for row in rows(f)]
    ),
    'numbers in quotes': lambda f: '\n'.join(
        [','.join(NAMES)] + [','.join(f'"{one}"' for one in row) for row in rows(f)]
    ),
    'decimal commas between semicolons': lambda f: '\n'.join(
        [';'.join(NAMES)] + [';'.join(map(comma, row)) for row in rows(f)]
    ),
    'decimal commas in quotes between commas': lambda f: '\n'.join(
        [','.join(NAMES)] + [','.join(f'"{comma(one)}"' for one in row) for row in rows(f)]
    ),
    'lists in quotes': lambda f: '\n'.join(
        ['t,p,q'] + [f'{t},"{row[:3]}","{row[3:]}"' for t, *row in rows(f)]
    ),
    'arrays of NumPy': lambda f: '\n'.join(
        ['t,p,q'] + [f'{t},"array({row[:3]})","array({row[3:]})"' for t, *row in rows(f)]
    ),
    'lists of NumPy': lambda f: '\n'.join(
        ['t;p;q'] + [f'{t};{row[:3]};{row[3:]}'.replace(', ', ' ') for t, *row in rows(f)]
    ),
    'names repeated in quotes': lambda f: '\n'.join(
        line
        for k, row in enumerate(rows(f))
        for line in ([','.join(f'"{n}"' for n in NAMES)] if k % 20 == 0 else [])
        + [','.join(map(str, row))]
    ),
    'ros2 topic echo': write_echo,
}


@pytest.mark.parametrize('write', FORMS.values(), ids=FORMS)
def test_a_text_is_read_in_whatever_form_it_is(write, tmp_path):
    f = lab_flight()
    path = tmp_path / 'log.csv'
    path.write_text(write(f) + '\n')
    table = read_text_file(path)[0]['']
    numbers = [cells for cells in table.values() if cells.dtype.kind in 'fi']
    np.testing.assert_allclose(np.column_stack(numbers[-7:]), [row[1:] for row in rows(f)])


@pytest.mark.parametrize('encoding', ['latin-1', 'cp1252', 'utf-8-sig', 'utf-16', 'utf-16-le'])
def test_a_degree_sign_in_any_encoding(encoding, tmp_path):
    f = lab_flight()
    names = ['Zeit [s]', 'x [m]', 'y [m]', 'z [m]', 'roll [\xb0]', 'pitch [\xb0]', 'yaw [\xb0]']
    table = np.column_stack([f['t'], f['p'], np.degrees(f['rpy'])])
    lines = [';'.join(names), *(';'.join(map(comma, row)) for row in table)]
    path = tmp_path / 'log.csv'
    path.write_bytes('\r\n'.join(lines).encode(encoding))
    assert detect_encoding(path.read_bytes()[:4096])
    text = draft_mapping(path, {}).text
    assert 'sequence: ZYX, unit: deg' in text
    assert 'Zeit [s]' in text


@pytest.mark.parametrize(
    ('sep', 'between', 'point', 'quote'),
    [(',', ',', '.', '"'), (';', ',', '.', ''), (';', '.', ',', ''), (',', '.', ',', '"')],
)
def test_marks_between_thousands_and_words_for_no_number(sep, between, point, quote, tmp_path):
    f = lab_flight(seconds=4.0)
    place = 1000.0 * f['p']  # mm, of 500 to 3000

    def write(value):
        text = f'{value:,.3f}'.replace(',', '\0').replace('.', point).replace('\0', between)
        return f'{quote}{text}{quote}'

    lines = [sep.join(('t', 'x', 'y', 'z'))]
    lines += [sep.join(map(write, row)) for row in np.column_stack([f['t'], place])]
    lines[7] = sep.join(['N/A', *lines[7].split(sep)[1:]]) if sep == ';' else lines[7]
    path = tmp_path / 'log.csv'
    path.write_text('\n'.join(lines) + '\n')
    (table,) = read_text_file(path)[0].values()
    np.testing.assert_allclose(np.column_stack([table[one] for one in 'xyz']), place, atol=1e-3)
    assert np.isnan(table['t']).sum() == (sep == ';')


def test_three_decimals_behind_a_comma_are_no_thousands(tmp_path):
    path = tmp_path / 'log.csv'
    path.write_text('t;x\n' + ''.join(f'0,{k:03d};1,{k:03d}\n' for k in range(1, 60)))
    (table,) = read_text_file(path)[0].values()
    np.testing.assert_allclose(table['x'], 1.0 + 1e-3 * np.arange(1, 60))


def test_whole_numbers_of_a_list_are_no_thousands(tmp_path):
    path = tmp_path / 'log.csv'
    rows = ''.join(f'0.{k};[120,200,300,150];5\n' for k in range(1, 60))
    path.write_text('t;pwm;n\n' + rows)
    (table,) = read_text_file(path)[0].values()
    lists = [table[name] for name in table if name not in ('t', 'n')]
    np.testing.assert_array_equal(np.column_stack(lists)[0], [120, 200, 300, 150])


def test_binary_data_are_no_text():
    assert detect_encoding(bytes(range(256)) * 8) == ''


def test_a_second_log_in_the_same_file_is_named(tmp_path):
    path = tmp_path / 'log.csv'
    path.write_text('t,x,y\n0,1,2\n1,1,2\n2,1,2\nt,volt,amp\n0,4,5\n1,4,5\n')
    with pytest.raises(BadInput, match=r'Row 4 of .* \(t, volt, amp\): another log begins there'):
        read_text_file(path)


def test_a_second_table_with_other_columns_is_named(tmp_path):
    path = tmp_path / 'log.csv'
    first = ['t,volt', *(f'{k},4' for k in range(100))]
    lines = [*first, 't,x,y,z', *(f'{k},1,2,3' for k in range(120))]
    path.write_text('\n'.join(lines) + '\n')
    with pytest.raises(BadInput, match="Another table begins with 't,x,y,z'"):
        read_text_file(path)


@pytest.mark.parametrize('names', ['', 't,x,y,z\n'])
def test_a_time_that_begins_anew_is_another_log(names, tmp_path):
    path = tmp_path / 'log.csv'
    block = ''.join(f'{0.02 * k:.2f},{0.1 * k},1,2\n' for k in range(100))
    path.write_text(f't,x,y,z\n{block}{names}{block}')
    with pytest.raises(BadInput, match=r'begin anew in row 101, at 0 after 1\.98: another log'):
        draft_mapping(path, {})


@pytest.mark.parametrize(('first', 'later'), [
    ('01.02.2026 12:00:00.5', '01.02.2026 12:00:01.25'), ('12:00:00.5', '12:00:01.25'),
    ('9:59:59,000', '9:59:59,750'),
])  # fmt: skip
def test_a_time_of_day_is_a_time(first, later, tmp_path, bring):
    source = tmp_path / 'log.csv'
    source.write_text(f'clock;x;y;z\n{first};1;2;3\n{later};1;2;3\n')
    mapping = (
        'schema: 1\nname: day\nabout: a test\nformat: csv\ntext: {delimiter: ";"}\n'
        'time: {column: clock}\ntopics:\n  - topic: ground_truth/odom\n'
        '    position: {columns: [x, y, z], unit: m}\n'
    )
    stamps = bring(source, mapping).stamps('/lta1/ground_truth/odom')
    assert stamps[1] - stamps[0] == 750_000_000


def take(f, bodies):
    """Return a take of Motive: y up, mm, angles about x, y and z, with each body's ID and name."""
    parts = ['Rotation'] * 3 + ['Position'] * 3
    head = [
        'Format Version,1.23,Take Name,T,Rotation Type,XYZ,Length Units,Millimeters',
        '',
        ',,' + ','.join('Rigid Body' for _ in bodies for _ in parts),
        ',,' + ','.join(name for name, _, _ in bodies for _ in parts),
        ',,' + ','.join(f'{len(name)}F3' for name, _, _ in bodies for _ in parts),
        ',,' + ','.join(part for _ in bodies for part in parts),
        'Frame,Time (Seconds),' + ','.join('XYZXYZ' * len(bodies)),
    ]
    cells = [np.hstack([angles, place]) for _, angles, place in bodies]
    table = np.column_stack([np.arange(len(f['t'])), f['t'], *cells])
    return '\n'.join([*head, *(','.join(f'{one:.6f}' for one in row) for row in table)]) + '\n'


@pytest.mark.parametrize('first', [True, False])
def test_a_take_of_motive_is_read_as_it_states(first, tmp_path, bring):
    f = lab_flight()
    up = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    turn = Rotation.from_matrix(up @ Rotation.from_quat(f['q']).as_matrix() @ up.T)
    ship = ('ship', turn.as_euler('XYZ', degrees=True), 1e3 * f['p'] @ up.T)
    rod = ('rod', np.full_like(f['p'], 0.3), np.full_like(f['p'], -40.0))
    source = tmp_path / 'take.csv'
    source.write_text(take(f, (ship, rod) if first else (rod, ship)))
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    poses = bring(source, draft.text).messages['/lta1/ground_truth/odom']
    places = [[getattr(one.pose.pose.position, axis) for axis in 'xyz'] for one in poses]
    np.testing.assert_allclose(places, f['p'], atol=1e-4)
    turns = [[getattr(one.pose.pose.orientation, axis) for axis in 'xyzw'] for one in poses]
    apart = Rotation.from_quat(turns).inv() * Rotation.from_quat(f['q'])
    assert np.degrees(apart.magnitude()).max() < 0.1
