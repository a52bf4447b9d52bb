# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Text with columns: unchanged in value, in the order of the file."""

import gzip
import hashlib
import math
import re
import shutil
import struct

from hypothesis import given, HealthCheck, settings
from hypothesis import strategies as st
from lta_config.errors import BadInput
from lta_data.importers.formats import detect_format
from lta_data.importers.readers.csv_text import read_header
from lta_data.importers.readers.text_dialect import detect_text_format
import numpy as np
import pytest

from .csv_texts import HEAD, ODOM, POSE, text


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


def test_a_force_without_a_column_on_an_axis_is_zero_there(bring, tmp_path):
    mapping = POSE + (
        '  - topic: wrench_command\n'
        '    force: {columns: [f, null, null], unit: N}\n'
        '    torque: {columns: [null, null, n], unit: mN m}\n'
    )
    found = bring(text(tmp_path / 'a.csv', 't,x,y,z,f,n', '5,1,2,3,0.5,20'), mapping)
    (wrench,) = (one.wrench for one in found.messages['/lta1/wrench_command'])
    assert (wrench.force.x, wrench.force.y, wrench.force.z) == (0.5, 0.0, 0.0)
    assert (wrench.torque.x, wrench.torque.y, wrench.torque.z) == (0.0, 0.0, 0.02)


def test_each_column_of_a_force_may_have_its_own_scale(bring, tmp_path):
    mapping = POSE + (
        '  - topic: wrench_command\n'
        '    force: {columns: [u, null, w], unit: N, scale: [0.12, 0, 0.05]}\n'
    )
    found = bring(text(tmp_path / 'a.csv', 't,x,y,z,u,w', '5,1,2,3,0.5,-1'), mapping)
    (wrench,) = (one.wrench for one in found.messages['/lta1/wrench_command'])
    assert (wrench.force.x, wrench.force.y, wrench.force.z) == (0.06, 0.0, -0.05)


@pytest.mark.parametrize(
    ('columns', 'sentence'),
    [
        ('[x, null, z]', "position of topic 'ground_truth/odom' lacks a column; only a force or"),
        ('[null, null, null]', 'has no column at all'),
    ],
)
def test_a_place_without_a_column_is_refused(bring, tmp_path, columns, sentence):
    mapping = POSE.replace('[x, y, z]', columns)
    with pytest.raises(BadInput, match=re.escape(sentence)):
        bring(text(tmp_path / 'a.csv', 't,x,y,z', '5,1,2,3'), mapping)


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
        '8,nan,NaN,,7',
    )
    found = bring(source, POSE)
    assert found.stamps(ODOM) == [4_500_000_000, 5_000_000_000, 5_000_000_000, 7_000_000_000]
    xs = [message.pose.pose.position.x for message in found.messages[ODOM]]
    assert np.isnan(xs).tolist() == [True, False, False, True]
    for sentence in (
        'The time goes back once, first in row 3; these rows are kept.',
        'The time repeats once; these rows are kept.',
        "Column 'x' lacks a number 2 times; the bag has NaN there.",
        f'2 rows have no values for {ODOM} and are left out there.',
        'The mapping does not use these columns of the log: u.',
    ):
        assert sentence in found.notes


def test_a_command_that_is_nan_ends_the_one_before_it(bring, tmp_path):
    """PX4 commands NaN to stopped motors. An empty cell is a row of another topic: no command."""
    mapping = POSE + '  - topic: motors\n    actuators: {left: {effort: {column: u}}}\n'
    source = text(tmp_path / 'a.csv', 't,x,y,z,u', '5,1,2,3,0.7', '6,1,2,3,nan', '7,1,2,3,',
                  '8,nan,nan,nan,nan')  # fmt: skip
    found = bring(source, mapping)
    efforts = [message.effort[0] for message in found.messages['/lta1/motors']]
    assert efforts[0] == 0.7
    assert np.isnan(efforts[1:]).tolist() == [True, True]
    assert found.stamps('/lta1/motors') == [5 * 10**9, 6 * 10**9, 8 * 10**9]
    assert found.stamps(ODOM) == [5 * 10**9, 6 * 10**9, 7 * 10**9]
    assert "Column 'u' lacks a number 2 times; the bag has NaN there." in found.notes
    assert "Column 'x' lacks" not in found.notes


def test_compressed_text_comments_blanks_and_names_with_spaces(bring, tmp_path):
    source = tmp_path / 'trace.txt'
    source.write_bytes(
        gzip.compress(b'# made by hand\n\n5.5  1 2\t3 0 0 0 1\n# more\n6 4 5 6 0 0 0 1\n')
    )
    found = bring(source, 'tum')
    positions = [message.pose.pose.position for message in found.messages[ODOM]]
    assert [(p.x, p.y, p.z) for p in positions] == [(1, 2, 3), (4, 5, 6)]
    assert found.stamps(ODOM) == [5_500_000_000, 6_000_000_000]


@pytest.mark.parametrize('encoding', ['utf-16-le', 'utf-16-be'])
@pytest.mark.parametrize('torn', [False, True])
def test_a_spreadsheet_in_utf16_is_read_by_its_byte_order_mark(bring, tmp_path, encoding, torn):
    """Also where the last line ends within a character."""
    source = tmp_path / 'a.csv'
    lines = '\ufefft,x,y,z,tilt [\N{DEGREE SIGN}]\r\n5.5,1,2,3,8\r\n6,4,5,6,9\r\n'
    source.write_bytes((lines + '7,1' * torn).encode(encoding)[: -1 if torn else None])
    assert detect_format(source) == 'csv'
    assert detect_text_format(source).delimiter == ','
    assert read_header(source)[-1] == 'tilt [\N{DEGREE SIGN}]'
    found = bring(source, POSE)
    positions = [message.pose.pose.position for message in found.messages[ODOM]]
    assert [(p.x, p.y, p.z) for p in positions] == [(1, 2, 3), (4, 5, 6)]


def test_other_delimiters_padded_names_and_lines_before_them(bring, tmp_path):
    source = text(tmp_path / 'a.csv', 'a title', ' t ; x; y ;z;', '5; 1;  2;3;', '6;4;5;6;')
    found = bring(source, POSE + 'text: {delimiter: ";", skip: 1}\n')
    positions = [message.pose.pose.position for message in found.messages[ODOM]]
    assert [(p.x, p.y, p.z) for p in positions] == [(1, 2, 3), (4, 5, 6)]


def test_the_bag_says_where_it_comes_from(bring, tmp_path):
    source = text(tmp_path / 'flight.log.csv', 't,x,y,z', '5,1,2,3')
    found = bring(source, POSE, robot='hawk', vehicle='rgblimp')
    from lta_bag.reader import read_bag

    told = read_bag(found.imported.bag).provenance
    assert told['source'] == 'flight.log.csv'
    assert told['source_sha256'] == hashlib.sha256(source.read_bytes()).hexdigest()
    assert told['source_size'] == str(source.stat().st_size)
    assert told['mapping_file'] == POSE
    assert (told['mapping'], told['data'], told['format']) == ('mine', 'measured', 'csv')
    assert told['vehicle'] == 'rgblimp'
    assert 'moving_mass' in told['vehicle_file']
    assert list(found.messages) == ['/hawk/ground_truth/odom']


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
