"""Text with columns: unchanged in value, in the order of the file; faults with their row."""

import gzip
import hashlib
import math
from pathlib import Path
import shutil
import struct

from hypothesis import given, HealthCheck, settings
from hypothesis import strategies as st
from lta_analysis.foreign.csv_text import is_number
from lta_analysis.foreign.row_times import exact
from lta_config.errors import BadInput
import numpy as np
import pytest

ODOM = '/lta1/ground_truth/odom'
HEAD = 'schema: 1\nname: mine\nabout: a test\nformat: csv\n'
POSE = HEAD + (
    'time: {column: t, unit: s}\n'
    'topics:\n'
    '  - topic: ground_truth/odom\n'
    '    position: {columns: [x, y, z], unit: m}\n'
)


def text(path, *lines):
    path.write_text('\n'.join(lines) + '\n')
    return path


def test_numbers_units_axes_and_constants_by_hand(bring, tmp_path):
    mapping = HEAD + (
        'time: {column: ms, unit: ms}\n'
        'data: simulated\n'
        'world: NED\n'
        'body: FRD\n'
        'topics:\n'
        '  - topic: ground_truth/odom\n'
        '    position: {columns: [n, e, d], unit: cm}\n'
        '    orientation: {euler: [yaw], sequence: Z, unit: deg}\n'
        '    velocity: {columns: [vn, ve, vd], unit: m/s, frame: world}\n'
        '    rates: {columns: [p, q, r], unit: deg/s}\n'
        '  - topic: imu\n'
        '    acceleration: {columns: [ax, ay, az], unit: m/s2, scale: 9.80665}\n'
        '  - topic: battery\n'
        '    voltage: {column: mv, unit: mV}\n'
        '    charge: {column: mah, unit: mA h}\n'
        '    capacity: {value: 250 mA h}\n'
        '  - topic: motors\n'
        '    actuators:\n'
        '      left: {effort: {column: pwm, offset: -1000, over: 1000}}\n'
        '      weight: {position: {column: cm, unit: cm}}\n'
        '  - topic: wrench_command\n'
        '    force: {columns: [p, q, r], unit: mN}\n'
        '    torque: {value: {value: [0, 1, 2], unit: N m}}\n'
    )
    names = 'ms,n,e,d,yaw,vn,ve,vd,p,q,r,ax,ay,az,mv,mah,pwm,cm'
    source = text(
        tmp_path / 'flight.csv',
        names,
        '2000,100,200,-300,90,0,2,-1,10,20,30,0,0,-1,3700,125,1250,7',
    )
    found = bring(source, mapping)
    (odom,) = found.messages[ODOM]
    p, q = odom.pose.pose.position, odom.pose.pose.orientation
    assert (p.x, p.y, p.z) == (2.0, 1.0, 3.0)
    # The nose to the east in NED is yaw 0 in ENU; 2 m/s to the east are 2 m/s forward.
    assert [q.x, q.y, q.z, q.w] == pytest.approx([0, 0, 0, 1], abs=1e-15)
    v, w = odom.twist.twist.linear, odom.twist.twist.angular
    assert [v.x, v.y, v.z] == pytest.approx([2, 0, 1], abs=1e-12)
    degree = math.pi / 180
    assert (w.x, w.y, w.z) == (10 * degree, -20 * degree, -30 * degree)
    assert not odom.pose.covariance.any()
    assert not odom.twist.covariance.any()
    assert (odom.header.frame_id, odom.child_frame_id) == ('map', 'base_link')
    assert found.stamps(ODOM) == found.times[ODOM] == [2_000_000_000]
    (imu,) = found.messages['/lta1/imu']
    assert imu.linear_acceleration.z == 9.80665
    assert (imu.orientation_covariance[0], imu.angular_velocity_covariance[0]) == (-1, -1)
    assert math.isnan(imu.angular_velocity.x)
    (battery,) = found.messages['/lta1/battery']
    single = struct.unpack('<f', struct.pack('<f', 3.7))[0]
    assert (battery.voltage, battery.charge, battery.capacity) == (single, 0.125, 0.25)
    assert math.isnan(battery.current)
    assert battery.present
    (motors,) = found.messages['/lta1/motors']
    assert motors.name == ['left', 'weight']
    assert motors.effort[0] == 0.25
    assert math.isnan(motors.effort[1])
    assert motors.position[1] == 0.07
    assert len(motors.velocity) == 0
    (wrench,) = found.messages['/lta1/wrench_command']
    force, torque = wrench.wrench.force, wrench.wrench.torque
    assert (force.x, force.y, force.z) == (0.01, -0.02, -0.03)
    assert (torque.x, torque.y, torque.z) == (0.0, -1.0, -2.0)
    assert found.imported.data == 'simulated'


def test_pose_alone_says_that_the_rest_is_unknown(bring, tmp_path):
    found = bring(text(tmp_path / 'a.csv', 't,x,y,z', '5,1,2,3'), POSE)
    (odom,) = found.messages[ODOM]
    assert odom.twist.covariance[0] == odom.twist.covariance[21] == -1.0
    assert odom.pose.covariance[21] == -1.0
    assert odom.pose.covariance[0] == 0.0
    q = odom.pose.pose.orientation
    assert (q.x, q.y, q.z, q.w) == (0, 0, 0, 0)
    assert math.isnan(odom.twist.twist.linear.x)


def test_what_is_odd_is_kept_and_named(bring, tmp_path):
    source = text(
        tmp_path / 'a.csv',
        't,x,y,z,u',
        '5.0,1,2,3,7',
        '5.0,1,2,3,7',
        '4.5,nan,2,3,7',
        '6,,,,7',
        '7,,2,3,7',
    )
    found = bring(source, POSE)
    assert found.stamps(ODOM) == [4_500_000_000, 5_000_000_000, 5_000_000_000, 7_000_000_000]
    xs = [message.pose.pose.position.x for message in found.messages[ODOM]]
    assert np.isnan(xs).tolist() == [True, False, False, True]
    for sentence in (
        'Time goes back once, first in row 3; kept.',
        'Time stands still once; kept.',
        "Column 'x' has no number 3 times; NaN in the bag.",
        f'1 rows have nothing for {ODOM} and give no message there.',
        'Not taken by the mapping: u.',
    ):
        assert sentence in found.notes


def test_rows_keep_the_order_of_the_file(bring, tmp_path):
    """Two topics of a row come one after the other, also where the time goes back."""
    mapping = POSE + '  - topic: range\n    range: {column: h, unit: mm}\n'
    source = text(tmp_path / 'a.csv', 't,x,y,z,h', '9,1,2,3,4', '8,1,2,3,', '7,1,2,3,5')
    found = bring(source, mapping)
    from lta_analysis.bag.reader import read_bag

    met = [(topic, time) for topic, time, _ in read_bag(found.imported.bag).messages()]
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
    assert exact(texts[:1], 's', 't', 0).times.tolist() == [whole]
    assert exact(texts[1:], 'ns', 't', 0).times.tolist() == [whole]


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_the_one_nearest_to_its_text(value):
    import pyarrow as pa
    import pyarrow.compute as pc

    assert pc.cast(pa.array([repr(value)]), pa.float64())[0].as_py() == value
    assert is_number(repr(value))


def test_compressed_text_comments_blanks_and_names_with_spaces(bring, tmp_path):
    source = tmp_path / 'trace.txt'
    source.write_bytes(
        gzip.compress(b'# made by hand\n\n5.5  1 2\t3 0 0 0 1\n# more\n6 4 5 6 0 0 0 1\n')
    )
    found = bring(source, 'tum')
    positions = [message.pose.pose.position for message in found.messages[ODOM]]
    assert [(p.x, p.y, p.z) for p in positions] == [(1, 2, 3), (4, 5, 6)]
    assert found.stamps(ODOM) == [5_500_000_000, 6_000_000_000]


def test_other_delimiters_padded_names_and_lines_before_them(bring, tmp_path):
    source = text(tmp_path / 'a.csv', 'a title', ' t ; x; y ;z;', '5; 1;  2;3;', '6;4;5;6;')
    found = bring(source, POSE + 'text: {delimiter: ";", skip: 1}\n')
    positions = [message.pose.pose.position for message in found.messages[ODOM]]
    assert [(p.x, p.y, p.z) for p in positions] == [(1, 2, 3), (4, 5, 6)]


def test_the_bag_says_where_it_comes_from(bring, tmp_path):
    source = text(tmp_path / 'flight.log.csv', 't,x,y,z', '5,1,2,3')
    found = bring(source, POSE, robot='hawk', vehicle='rgblimp')
    from lta_analysis.bag.reader import read_bag

    told = read_bag(found.imported.bag).provenance
    assert told['source'] == 'flight.log.csv'
    assert told['source_sha256'] == hashlib.sha256(source.read_bytes()).hexdigest()
    assert told['source_size'] == str(source.stat().st_size)
    assert told['mapping_file'] == POSE
    assert (told['mapping'], told['data'], told['format']) == ('mine', 'measured', 'csv')
    assert told['vehicle'] == 'rgblimp'
    assert 'moving_mass' in told['vehicle_file']
    assert list(found.messages) == ['/hawk/ground_truth/odom']


def test_parts_of_a_long_text_join_without_a_seam(bring, tmp_path, monkeypatch):
    monkeypatch.setattr('lta_analysis.foreign.csv_text.PART', 1 << 12)
    lines = ['t,x,y,z', *(f'{5 + k}.125,{k},{k / 3!r},{-k}' for k in range(2000))]
    found = bring(text(tmp_path / 'a.csv', *lines), POSE)
    positions = [message.pose.pose.position for message in found.messages[ODOM]]
    assert [p.x for p in positions] == list(range(2000))
    assert [p.y for p in positions] == [k / 3 for k in range(2000)]
    assert found.stamps(ODOM) == [(5 + k) * 10**9 + 125_000_000 for k in range(2000)]
    assert not found.imported.notes


WRONG = {
    'missing column': (('t,x,y', '5,1,2'), "has no column 'z'; it has t, x, y"),
    'no time column': (('x,y,z', '1,2,3'), "has no column 't'; it has x, y, z"),
    'not a number': (('t,x,y,z', '5,1,2,3', '6,1,oops,3'), "'oops' in column 'y', row 2"),
    'comma as point': (('t,x,y,z', '5,"1,5",2,3'), "'1,5' in column 'x', row 1"),
    'no time': (('t,x,y,z', '5,1,2,3', ',1,2,3'), "Column 't' has nothing in row 2"),
    'wrong time': (('t,x,y,z', '5 o,1,2,3'), "Column 't' has '5 o' in row 1"),
    'short row': (('t,x,y,z', '5,1,2,3', '6,1'), 'Expected 4 columns, got 2'),
    'only names': (('t,x,y,z',), 'but no rows'),
    'too late': (('t,x,y,z', '5e9,1,2,3'), 'which ROS cannot stamp'),
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


def test_a_cut_compressed_text_is_refused(bring, tmp_path):
    lines = '\n'.join(f'{k},1,2,3' for k in range(5, 50_000))
    source = tmp_path / 'a.csv.gz'
    source.write_bytes(gzip.compress(f't,x,y,z\n{lines}\n'.encode())[:-2000])
    with pytest.raises(BadInput, match='compression is damaged or cut short'):
        bring(source, POSE)


MAPPINGS = {
    'dimension': ('unit: m}', 'unit: m/s}', 'position is in m/s, but must be in m'),
    'no unit': (', unit: m}', '}', 'position has no unit; add "unit: m"'),
    'unknown unit': ('unit: m}', 'unit: feet}', 'no known unit'),
    'unknown topic': ('ground_truth/odom', 'odometry', "Unknown topic to import into 'odometry'"),
    'unknown part': (
        'position:',
        'pressure: {column: x}\n    position:',
        'known: orientation, position',
    ),
    'unknown key': ('position:', 'place:', 'not known'),
    'two times': ('unit: s}', 'unit: s, rate: 50 Hz}', 'needs one of "column", "rate" and "step"'),
    'no time': ('time: {column: t, unit: s}\n', '', 'needs the key "time"'),
    'time unit': ('unit: s}', 'unit: m}', 'must be in s, ms, us or ns'),
    'two columns': ('[x, y, z]', '[x, y]', 'must have at least 3'),
    'axes': ('topics:', 'world: [x, x, z]\ntopics:', 'each once'),
    'named axes': ('topics:', 'world: DOWN\ntopics:', 'known axes are ENU'),
    'actuators': ('position:', 'actuators: {m1: {}}\n    position:', 'only motors has'),
    'world velocity': (
        'position:',
        'velocity: {columns: [x, y, z], unit: m/s, frame: world}\n    position:',
        'give the orientation beside it',
    ),
    'mirror': (
        'position:',
        'world: [x, -y, z]\n    orientation: {quaternion: [t, x, y, z]}\n    position:',
        'different handedness',
    ),
    'two attitudes': (
        'position:',
        'orientation: {euler: [x], sequence: Z, matrix: [x,x,x,x,x,x,x,x,x]}\n    position:',
        'needs one of "quaternion"',
    ),
    'sequence': ('position:', 'orientation: {euler: [x, y]}\n    position:', '2 angles for'),
    'turns twice': (
        'position:',
        'orientation: {euler: [x, y], sequence: ZZ}\n    position:',
        'turns twice about one axis',
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


UNITS = {'m': 1.0, 'cm': 1e-2, 'mm': 1e-3}


@given(
    st.lists(st.tuples(*[st.floats(-1e9, 1e9)] * 3), min_size=1, max_size=5),
    st.sampled_from(sorted(UNITS)),
    st.permutations('xyz'),
    st.tuples(*[st.sampled_from(('', '-'))] * 3),
)
@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_numbers_come_out_as_plain_arithmetic_says(bring, tmp_path, rows, unit, order, signs):
    """To the last bit: number times unit, picked and negated; no other operation."""
    axes = [sign + axis for sign, axis in zip(signs, order, strict=True)]
    lines = [f'{k + 5},{x!r},{y!r},{z!r}' for k, (x, y, z) in enumerate(rows)]
    mapping = POSE.replace('unit: m}', f'unit: {unit}}}') + f'world: [{", ".join(axes)}]\n'
    shutil.rmtree(tmp_path / 'out', ignore_errors=True)
    found = bring(text(tmp_path / 'a.csv', 't,x,y,z', *lines), mapping)
    for row, message in zip(rows, found.messages[ODOM], strict=True):
        p = message.pose.pose.position
        numbers = dict(zip('xyz', row, strict=True))
        factors = [-1.0 if axis[0] == '-' else 1.0 for axis in axes]
        wanted = [
            factor * (numbers[axis[-1]] * UNITS[unit])
            for axis, factor in zip(axes, factors, strict=True)
        ]
        assert [p.x, p.y, p.z] == wanted


@pytest.mark.parametrize('ending', ['\n', '\r\n'])
def test_a_mark_of_byte_order_quotes_and_line_endings(bring, tmp_path, ending):
    rows = ['"t","x","y","z"', '5,1,2,3', '"6","4","5","6"']
    source = tmp_path / 'a.csv'
    source.write_bytes(b'\xef\xbb\xbf' + ending.join(rows).encode())
    found = bring(source, POSE)
    positions = [message.pose.pose.position for message in found.messages[ODOM]]
    assert [(p.x, p.y, p.z) for p in positions] == [(1, 2, 3), (4, 5, 6)]


def test_actuators_that_the_vehicle_does_not_have_are_named(bring, tmp_path):
    mapping = POSE + (
        '  - topic: motors\n'
        '    actuators:\n'
        '      left: {effort: {column: x, unit: N}}\n'
        '      moving_mass_x: {position: {column: y, unit: m}}\n'
        '      tail: {effort: {column: z}}\n'
    )
    found = bring(text(tmp_path / 'a.csv', 't,x,y,z', '5,1,2,3'), mapping, vehicle='rgblimp')
    assert "Vehicle 'rgblimp' has no tail; it has left, moving_mass_x" in found.notes


DATES = {
    'zulu': (('2026-11-20T13:25:48Z', '2026-11-20T13:25:48.123456789Z'), 123_456_789),
    'offset': (('2026-11-20T15:25:48+02:00', '2026-11-20T15:25:48.5+0200'), 500_000_000),
    'blank': (('2026-11-20 13:25:48', '2026-11-20 13:25:48,000001'), 1_000),
    'basic': (('20261120T132548Z', '20261120T132548.25Z'), 250_000_000),
}


@pytest.mark.parametrize('case', DATES)
def test_dates_are_times_to_the_last_digit(bring, tmp_path, case):
    times, fraction = DATES[case]
    source = text(tmp_path / 'a.csv', 't;x;y;z', *(f'{time};1;2;3' for time in times))
    found = bring(source, POSE.replace('format: csv', 'format: csv\ntext: {delimiter: ";"}'))
    start = 1_795_181_148 * 10**9  # date -u -d '2026-11-20 13:25:48' +%s
    assert found.stamps(ODOM) == [start, start + fraction]
    assert ('taken as UTC' in found.notes) == (case == 'blank')


@pytest.mark.parametrize(
    ('times', 'sentence'),
    [
        (('2026-11-20T13:25:48Z', '12.5'), "Column 't' has '12.5' in row 2, which is no time"),
        (('12.5', '2026-11-20T13:25:48Z'), "'2026-11-20T13:25:48Z' in row 2, which is no time"),
        (('2026-02-30T13:25:48Z',), "'2026-02-30T13:25:48Z' in row 1, which is no time"),
    ],
)
def test_what_is_no_time_is_named_with_its_row(bring, tmp_path, times, sentence):
    source = text(tmp_path / 'a.csv', 't,x,y,z', *(f'{time},1,2,3' for time in times))
    with pytest.raises(BadInput) as told:
        bring(source, POSE)
    assert sentence in str(told.value)


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
