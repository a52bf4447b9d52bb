# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A drafted mapping brings the files of a laboratory to the flight that they came from."""

import io
import json

from lta_analysis.import_draft import ask_user
from lta_config.errors import BadInput
from lta_config.schema.import_file import load_mapping
from lta_data.importers.draft.choices import DraftQuestion, DraftVehicle
from lta_data.importers.draft.draft_mapping import draft_mapping
import numpy as np
import pytest
from rich.console import Console
from scipy.spatial.transform import Rotation
import yaml

from .csv_texts import ODOM
from .lab_flights import DOWN, lab_flight, three, write_csv


def test_the_unit_of_several_turns_of_a_heading_is_asked(tmp_path):
    f = lab_flight()
    table = {'t': f['t'] + 5.0, **three('', f['p']), 'yaw': np.linspace(0.0, 12.0, len(f['t']))}
    draft = draft_mapping(write_csv(tmp_path / 'a.csv', table), {})
    (question,) = draft.choices.questions
    assert [name.split(', ')[1] for name, _ in question.options] == ['rad', 'deg']


@pytest.mark.parametrize(('size', 'scale', 'unit'), [
    (0.02, 1.0, 'rad'), (1.0, 1.0, 'rad'), (0.1, 57.29578, 'deg'), (1.0, 57.29578, 'deg'),
])  # fmt: skip
def test_small_angles_beside_velocities_that_are_late(tmp_path, size, scale, unit):
    """A lab derives velocity and rates from the poses, and filters them; it flies straight."""
    t = np.arange(0.0, 30.0, 0.05)
    angles = size * np.column_stack([
        0.2 * np.sin(4.0 * t), 0.15 * np.sin(4.3 * t) + 0.05, 0.1 + 0.4 * np.sin(0.5 * t),
    ])  # fmt: skip
    turn = Rotation.from_euler('ZYX', angles[:, ::-1])
    world = np.column_stack([0.1 * np.sin(0.3 * t), 0.05 * np.cos(0.4 * t), 0.02 * np.sin(t)])
    place = np.cumsum(world, axis=0) * 0.05 + [0.0, 0.0, 1.5]
    rates = np.gradient(angles, t, axis=0)
    late = [np.roll(one, 4, axis=0) for one in (turn.inv().apply(world), rates)]
    table = {
        't': t + 7.0, **three('v', late[0]), **three('w', scale * late[1]), **three('', place),
        **dict(zip(('phi', 'theta', 'psi'), scale * angles.T, strict=True)),
    }  # fmt: skip
    draft = draft_mapping(write_csv(tmp_path / 'a.csv', table), {})
    assert draft.choices.questions == []
    (topic,) = yaml.safe_load(draft.text)['topics']
    assert topic['orientation']['unit'] == unit
    assert topic['rates']['unit'] == f'{unit}/s'


@pytest.mark.parametrize(('vehicle', 'asked'), [('gtmab', []), ('multirotor', ['world.up'])])
def test_the_tilt_of_a_blimp_does_not_say_where_up_is(tmp_path, vehicle, asked):
    """Its gondola swings against its accelerations, below a map whose z points down."""
    t = np.arange(0.0, 40.0, 0.05)
    pull = 0.3 * np.sin(0.9 * t)
    place = np.column_stack([-pull / 0.81, 0.0 * t, -1.5 + 0.1 * np.sin(0.4 * t)])
    turn = Rotation.from_euler('y', 0.1 * pull[:, None])
    table = {'t': t + 3.0, **three('', place), **three('q', turn.as_quat(), 'xyzw')}
    path = write_csv(tmp_path / 'a.csv', table)
    answers = {'ground_truth/odom.position.unit': 'm'}
    draft = draft_mapping(path, answers, DraftVehicle.load(vehicle))
    assert [question.key for question in draft.choices.questions] == asked


def test_many_turns_of_a_heading_beside_small_tilts_are_in_radians(tmp_path):
    f = lab_flight()
    angles = {'roll': f['rpy'][:, 0], 'pitch': f['rpy'][:, 1], 'yaw': np.unwrap(f['rpy'][:, 2])}
    table = {'t': f['t'] + 5.0, **three('', f['p']), **angles, **three('v', f['v'])}
    draft = draft_mapping(write_csv(tmp_path / 'a.csv', table), {})
    assert draft.choices.questions == []
    assert yaml.safe_load(draft.text)['topics'][0]['orientation']['unit'] == 'rad'


def test_an_export_with_a_preamble_padded_rows_and_rounded_times(tmp_path):
    """As a tracker writes it: millimetres, a counter without a name, times of six digits."""
    f = lab_flight()
    letters = [*'XYZ', 'Vx', 'Vy', 'Vz', 'Qx', 'Qy', 'Qz', 'Qw']
    names = ['', 'Timestamp', *(f'{name}ToGlobal1' for name in letters)]
    world = np.gradient(f['p'], f['t'], axis=0)
    rows = np.column_stack([1000.0 * f['p'], 1000.0 * world, f['q']])
    # Where it lost the body, the poses are zero
    rows[200:280, [0, 1, 2, 6, 7, 8, 9]] = 0.0
    head = f'[Head];NumFrames,Rate,Units;{len(rows)},50,mm;;[Data]; Frame# ,,Segment1'
    lines = ['#Translation and Rotation (.csv) file', *head.split(';'), ','.join(names)]
    for k, row in enumerate(rows):
        cells = [f'{value:.6f}' for value in row]
        lines.append(','.join([str(k + 1), '1.76424E+12', *(cells if k > 1 else [' '] * 10)]))
    width = len(names)
    padded = [line + ',' * (width - line.count(',')) + ' ' for line in lines]
    (tmp_path / 'a.csv').write_text('\n'.join(padded) + '\n')
    draft = draft_mapping(tmp_path / 'a.csv', {})
    assert draft.choices.questions == []
    mapping = yaml.safe_load(draft.text)
    assert mapping['time'] == {'rate': '50 Hz'}
    (topic,) = mapping['topics']
    assert topic['position'] == {'columns': [f'{a}ToGlobal1' for a in 'XYZ'], 'unit': 'mm'}
    assert topic['velocity']['frame'] == 'world'
    assert topic['orientation']['order'] == 'xyzw'


@pytest.mark.parametrize(
    ('names', 'force', 'torque'),
    [
        ('fx fy fz tx ty tz', 'fx fy fz', 'tx ty tz'),
        ('Fx Fy Fz Mx My Mz', 'Fx Fy Fz', 'Mx My Mz'),
        ('fx fz tz', 'fx - fz', '- - tz'),
        ('cmd_fx cmd_fz cmd_torque_yaw', 'cmd_fx - cmd_fz', '- - cmd_torque_yaw'),
        ('f_x_cmd f_z_cmd m_z_cmd', 'f_x_cmd - f_z_cmd', '- - m_z_cmd'),
        ('tau_1 tau_2 tau_3 tau_4 tau_5 tau_6', 'tau_1 tau_2 tau_3', 'tau_4 tau_5 tau_6'),
        # Without a force, t is a translation; m1 is a motor, and f1 the force of one
        ('tx ty tz', '', ''),
        ('fz m1 m2 m3 m4', '- - fz', ''),
        ('f1 f2 f3 f4', '', ''),
        # What is commanded, not what is measured
        ('fx_meas tz_meas fx_cmd tz_cmd', 'fx_cmd - -', '- - tz_cmd'),
        ('fx_N fz_N tz_Nm', 'fx_N - fz_N', '- - tz_Nm'),
        ('cmd_fx_mN cmd_fz_mN cmd_tz_mNm', 'cmd_fx_mN - cmd_fz_mN', '- - cmd_tz_mNm'),
        ('thrust_x_N thrust_z_N M_z_Nm', 'thrust_x_N - thrust_z_N', '- - M_z_Nm'),
        ('thrust_x thrust_z torque_z', 'thrust_x - thrust_z', '- - torque_z'),
        ('forward_force vertical_force yaw_moment', 'forward_force - vertical_force',
         '- - yaw_moment'),
        ('fz_N', '- - fz_N', ''),
    ],
)  # fmt: skip
def test_commanded_forces_and_torques_are_found_by_axis(tmp_path, names, force, torque):
    """Many blimps are commanded on three of six axes; each lab has its own letters."""
    flight = lab_flight()
    columns = names.split()
    rng = np.random.default_rng(1)
    source = write_csv(tmp_path / 'a.csv', {
        'time': flight['t'] + 100.0, **three('p', flight['p']), **three('q', flight['q'], 'xyzw'),
        **{name: rng.uniform(0.0, 0.1, len(flight['t'])) for name in columns},
    })  # fmt: skip
    topics = yaml.safe_load(draft_mapping(source, {}).text)['topics']
    wrench = [one for one in topics if one['topic'] == 'wrench_command']
    wanted = {
        kind: [None if name == '-' else name for name in listed.split()]
        for kind, listed in (('force', force), ('torque', torque))
        if listed
    }
    found = {k: v['columns'] for one in wrench for k, v in one.items() if k != 'topic'}
    assert found == wanted


def test_the_file_of_a_tracker_has_its_names_in_several_lines(bring, tmp_path):
    """As Motive writes it: type, body, quantity and axis apart, y up, markers behind the body."""
    f = lab_flight()
    place, turned = (f[part][:, [0, 2, 1]] * [1, 1, -1] for part in 'pq')
    lines = [
        'Format Version,1.23,Take Name,blimp,Rotation Type,Quaternion,Length Units,Meters',
        '',
        ',Type' + 8 * ',Rigid Body' + 3 * ',Rigid Body Marker',
        ',Name' + 8 * ',Blimp' + 3 * ',Blimp:Marker1',
        ',ID' + 8 * ',A1' + 3 * ',B2',
        ',' + 4 * ',Rotation' + 3 * ',Position' + ',Mean Marker Error' + 3 * ',Position',
        'Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z',
    ]
    table = [np.arange(len(place)), f['t'], *turned.T, f['q'][:, 3], *place.T, 0.0 * f['t'],
             *(place + 0.1).T]  # fmt: skip
    rows = [','.join(f'{value:.9g}' for value in row) for row in np.column_stack(table)]
    source = tmp_path / 'take.csv'
    source.write_text('\n'.join([*lines, *rows]) + '\n')
    found, _, draft = import_drafted(bring, source)
    expect_flight(found, f, 'pq')
    mapping = yaml.safe_load(draft.text)
    assert mapping['time'] == {'column': 'Time (Seconds)', 'unit': 's'}
    assert 'Marker1' not in str(mapping['topics'])


def import_drafted(bring, source, answers=None):
    """Draft, require that nothing is open, import, and return the truth topic as arrays."""
    draft = draft_mapping(source, answers or {})
    assert draft.choices.questions == []
    got = bring(source, draft.text)
    poses = got.messages[ODOM]
    found = {
        'p': [[getattr(m.pose.pose.position, a) for a in 'xyz'] for m in poses],
        'q': [[getattr(m.pose.pose.orientation, a) for a in 'xyzw'] for m in poses],
        'v': [[getattr(m.twist.twist.linear, a) for a in 'xyz'] for m in poses],
        'w': [[getattr(m.twist.twist.angular, a) for a in 'xyz'] for m in poses],
    }
    return {name: np.array(rows) for name, rows in found.items()}, got, draft


def expect_flight(found, flight, parts='pqvw'):
    """Compare with the truth; the written digits limit the accuracy."""
    for part in parts:
        truth = flight[part]
        if part == 'q':
            angle = (Rotation.from_quat(found['q']).inv() * Rotation.from_quat(truth)).magnitude()
            assert angle.max() < 1e-6
        else:
            np.testing.assert_allclose(found[part], truth, atol=1e-6)


def test_millimetres_milliseconds_degrees_and_z_down(bring, tmp_path):
    f = lab_flight()
    # Frd angles: the same roll, pitch and yaw with y and z turned over
    rpy = np.degrees(f['rpy']) * DOWN
    source = write_csv(tmp_path / 'a.csv', {
        'timestamp': np.round((f['t'] + 7.0) * 1000.0), **three('pos_', f['p'] * DOWN * 1e3),
        'roll': rpy[:, 0], 'pitch': rpy[:, 1], 'yaw': rpy[:, 2],
        **three('vel_', f['v'] * DOWN), **three('gyro_', np.degrees(f['w']) * DOWN),
        **three('acc_', f['a'] * DOWN / 9.80665),
    }, ';')  # fmt: skip
    found, got, draft = import_drafted(bring, source)
    expect_flight(found, f, 'pv')
    expect_flight(found, f, 'q')
    imu = got.messages['/lta1/imu']
    felt = np.array([[getattr(m.linear_acceleration, a) for a in 'xyz'] for m in imu])
    np.testing.assert_allclose(felt, f['a'], atol=1e-5)
    turned = np.array([[getattr(m.angular_velocity, a) for a in 'xyz'] for m in imu])
    np.testing.assert_allclose(turned, f['w'], atol=1e-6)
    assert got.stamps(ODOM)[:2] == [7_000_000_000, 7_020_000_000]
    reasons = ' '.join(reason.reason for reason in draft.choices.reasons)
    assert 'the accelerometer feels 9.8' in reasons


def test_a_heading_alone_turns_a_level_vehicle(bring, tmp_path):
    f = lab_flight()
    source = write_csv(tmp_path / 'a.csv', {
        't': f['t'] + 5.0, **three('', f['p']), 'yaw': np.degrees(f['rpy'][:, 2]),
    })  # fmt: skip
    found, _, draft = import_drafted(bring, source)
    np.testing.assert_allclose(found['p'], f['p'], atol=1e-6)
    level = Rotation.from_euler('z', f['rpy'][:, 2:])
    assert (Rotation.from_quat(found['q']).inv() * level).magnitude().max() < 1e-6
    said = ' '.join(f'{one.reading} {one.reason}' for one in draft.choices.reasons)
    assert 'roll and pitch taken as 0' in said


def test_truth_estimate_and_command_are_told_apart_by_name(tmp_path):
    f = lab_flight()
    rng = np.random.default_rng(1)
    drift = f['p'] + np.cumsum(rng.normal(0.0, 1e-3, f['p'].shape), axis=0)
    source = write_csv(tmp_path / 'a.csv', {
        't': f['t'], **three('vicon_', f['p']), **three('ekf_', drift),
        **three('ref_', np.round(f['p'])), 'm1': 0.5 + 0.1 * np.sin(f['t']),
        'm2': 0.3 + 0.0 * f['t'],
        'vbat_mV': 3700.0 + 0.0 * f['t'],
    })  # fmt: skip
    draft = draft_mapping(source, {'ground_truth/odom.position.unit': 'm'})
    (tmp_path / 'm.yaml').write_text(draft.text)
    mapping, _ = load_mapping(str(tmp_path / 'm.yaml'))
    by_topic = {entry.topic: entry for entry in mapping.topics}
    assert by_topic['ground_truth/odom'].position.columns == ['vicon_x', 'vicon_y', 'vicon_z']
    assert by_topic['odom'].position.columns == ['ekf_x', 'ekf_y', 'ekf_z']
    assert by_topic['setpoint/pose'].position.columns == ['ref_x', 'ref_y', 'ref_z']
    assert by_topic['motors'].actuators['m1'].effort.unit == '1'
    assert by_topic['battery'].voltage.unit == 'mV'


@pytest.mark.parametrize(
    ('values', 'unit', 'extra'),
    [
        ([0.2, 0.9, 0.5], '1', {}),
        ([20.0, 95.0, 50.0], '%', {}),
        ([1000.0, 1900.0, 1300.0], '1', {'offset': -1000.0, 'over': 1000.0}),
        # Motors stand in the middle between forward and back
        ([1500.0, 1900.0, 1200.0], '1', {'offset': -1500.0, 'over': 500.0}),
        # A step in one direction
        ([1500.0, 1300.0, 1300.0], '1', {'offset': -1500.0, 'over': 500.0}),
        ([1600.0, 1900.0, 1800.0], '1', {'offset': -1000.0, 'over': 1000.0}),
        # It hovers about 1500, and never stands
        ([*range(1100, 1900, 3), *range(1485, 1515)], '?', {}),
        ([30.0, 240.0, 120.0], '1', {'over': 255.0}),
        ([3000.0, 60000.0, 30000.0], '1', {'over': 65535.0}),
    ],
)
def test_the_scale_of_motors_follows_from_their_size(tmp_path, values, unit, extra):
    f = lab_flight(10.0)
    command = np.resize(values, len(f['t']))
    source = write_csv(
        tmp_path / 'a.csv', {'time_s': f['t'], 'motor_1': command, 'motor_2': command}
    )
    draft = draft_mapping(source, {})
    assert bool(draft.choices.questions) == (unit == '?')
    (tmp_path / 'm.yaml').write_text(draft.text)
    effort = load_mapping(str(tmp_path / 'm.yaml'))[0].topics[0].actuators['motor_1'].effort
    assert effort.unit == unit.replace('?', '1')
    assert {name: getattr(effort, name) for name in extra} == extra


def test_a_folder_is_drafted_from_the_run_that_says_most(tmp_path):
    """Not from the first, in which nothing is commanded; nor from the longest."""
    f = lab_flight(10.0)
    for name, pulses, rows in (('a', [1500.0], 500), ('b', [1500.0, 1300.0], 400)):
        columns = {'time_s': f['t'], 'esc_l': np.resize(pulses, len(f['t']))}
        (tmp_path / 'runs').mkdir(exist_ok=True)
        write_csv(
            tmp_path / 'runs' / f'{name}.csv', {key: one[:rows] for key, one in columns.items()}
        )
    draft = draft_mapping(tmp_path / 'runs', {})
    assert draft.source.path.name == 'b.csv'
    assert 'Drafted from b.csv, in which most columns change.' in draft.source.notes
    assert 'offset: -1500' in draft.text


def test_pulses_that_may_reverse_a_motor_are_asked_about(tmp_path):
    f = lab_flight(10.0)
    command = np.resize([1100.0, 1900.0, 1700.0, 1300.0], len(f['t']))
    source = write_csv(tmp_path / 'a.csv', {'time_s': f['t'], 'pwm_l': command, 'pwm_r': command})
    draft = draft_mapping(source, {})
    assert [one.key for one in draft.choices.questions] == ['motors.unit']
    given = draft_mapping(source, {'motors.unit': 'pulse about 1500'})
    (motors,) = yaml.safe_load(given.text)['topics']
    effort = {'column': 'pwm_l', 'offset': -1500, 'over': 500}
    assert motors['actuators']['left'] == {'effort': effort}
    assert [*motors['actuators']] == ['left', 'right']


def test_commands_of_places_are_actuators_and_what_is_missing_is_said(call, tmp_path):
    f = lab_flight(10.0)
    names = 'cmd_left', 'cmd_down', 'knob', 'control_side_error'
    source = write_csv(tmp_path / 'a.csv', {'time_s': f['t'], **dict.fromkeys(names, f['t'] / 10)})
    status, told = call('import', '--draft', source, '--out', tmp_path / 'out')
    assert status == 0
    assert 'no position and no attitude; lta calibrate' in told.out
    assert 'Columns without a meaning: knob, control_side_error.' in told.out
    (motors,) = load_mapping(str(tmp_path / 'out' / 'mapping.yaml'))[0].topics
    assert [*motors.actuators] == ['left', 'down']
    (motors,) = yaml.safe_load(draft_mapping(source, {'knob.topic': 'motors'}).text)['topics']
    assert [*motors['actuators']] == ['knob']


@pytest.mark.parametrize(
    'head', [['t_s;X_m;Y_m;Z_m'], ['log 3', 't;X;Y;Z', 's;m;m;[m]'], ['t;X;Y;Z', 'tick;m;m;m']]
)
def test_a_table_with_decimal_commas_or_a_row_of_units(bring, tmp_path, head):
    rows = [f'{100 + k},5;0,{k}25;-1,5;2,5' for k in range(3)]
    source = tmp_path / 'a.csv'
    source.write_text('\n'.join([*head, *rows]) + '\n')
    got = bring(source, draft_mapping(source, {}).text)
    places = [message.pose.pose.position for message in got.messages[ODOM]]
    assert [(place.x, place.y) for place in places] == [
        (0.025, -1.5),
        (0.125, -1.5),
        (0.225, -1.5),
    ]
    assert got.stamps(ODOM) == [100_500_000_000, 101_500_000_000, 102_500_000_000]


def test_a_folder_of_sensors_gets_a_table_and_a_time_for_each(bring, tmp_path):
    f = lab_flight()
    folder = tmp_path / 'flight'
    folder.mkdir()
    write_csv(folder / 'vicon.csv', {
        't_ms': np.round(f['t'] * 1000) + 9000, **three('p', f['p']), **three('q', f['q'], 'xyzw'),
        **three('v', f['v']),
    })  # fmt: skip
    np.savez(folder / 'imu.npz', time=f['t'] + 9.0, gyro=f['w'], acc=f['a'])
    draft = draft_mapping(folder, {})
    assert draft.choices.questions == []
    got = bring(folder, draft.text)
    assert len(got.messages[ODOM]) == len(got.messages['/lta1/imu']) == len(f['t'])
    assert got.stamps(ODOM)[5] == got.stamps('/lta1/imu')[5] == 9_100_000_000
    force = got.messages['/lta1/imu'][7].linear_acceleration
    assert (force.x, force.y, force.z) == pytest.approx(tuple(f['a'][7]))


def ambiguous(path):
    """Write a flight whose heights are on both sides of zero, without an accelerometer."""
    f = lab_flight()
    middle = f['p'] - f['p'].mean(axis=0)
    columns = {'t': f['t'], **three('p', middle), **three('q', f['q'], 'xyzw'),
               **three('v', f['v'])}  # fmt: skip
    return write_csv(path, columns)


def test_without_a_terminal_both_readings_and_the_option_that_decides(call, tmp_path):
    source = ambiguous(tmp_path / 'a.csv')
    status, told = call('import', '--draft', source, '--out', tmp_path / 'out')
    assert status == 2
    assert '--set world.up=up' in told.out
    assert '--set world.up=down' in told.out
    assert 'open: two readings fit' in told.out
    assert 'as you decided' not in told.out
    assert not (tmp_path / 'out').exists()


@pytest.mark.parametrize(('up', 'world'), [('up', None), ('down', ('x', '-y', '-z'))])
def test_the_option_decides_and_the_mapping_and_its_page_are_written(call, tmp_path, up, world):
    source = ambiguous(tmp_path / 'a.csv')
    words = ['import', '--draft', source, '--out', tmp_path / 'out', '--set', f'world.up={up}']
    status, told = call(*words)
    assert status == 0
    assert 'What the columns are' in told.out
    mapping, _ = load_mapping(str(tmp_path / 'out' / 'mapping.yaml'))
    assert mapping.world == world
    assert 'panel-first-0' in (tmp_path / 'out' / 'report.html').read_text()
    assert json.loads((tmp_path / 'out' / 'draft.json').read_text())['unused'] == []
    assert call('import', source, '--mapping', tmp_path / 'out' / 'mapping.yaml',
               '--out', tmp_path / 'bag')[0] == 0  # fmt: skip


@pytest.mark.parametrize(
    ('words', 'sentence'),
    [
        (['--set', 'world.up=left'], "Unknown answer to world.up 'left'; known: down, up"),
        (['--set', 'world.upp=up'], '--set world.upp decides nothing in this log'),
        (['--set', 'up'], "--set 'up' is not KEY=VALUE"),
    ],
)
def test_a_wrong_answer_is_one_sentence(call, tmp_path, words, sentence):
    source = ambiguous(tmp_path / 'a.csv')
    status, told = call('import', '--draft', source, '--out', tmp_path / 'out', *words)
    assert status == 2
    assert sentence in ' '.join((told.out + told.err).split())


def test_on_a_terminal_a_question_is_asked_until_it_is_answered(monkeypatch):
    question = DraftQuestion('world.up', [('up', 'z is up'), ('down', 'z is down')], 'Both fit.')
    console = Console(record=True, width=80, file=io.StringIO())
    answers = iter(['', 'sideways', ' down '])
    monkeypatch.setattr('builtins.input', lambda: next(answers))
    assert ask_user(question, console) == 'down'
    said = console.export_text()
    assert said.count('world.up (up, down):') == 3
    assert "'sideways' is none of them." in said

    def end():
        raise EOFError

    monkeypatch.setattr('builtins.input', end)
    with pytest.raises(BadInput, match=r'ended before world\.up .* --set world\.up=up or'):
        ask_user(question, console)


def test_a_published_flight_gets_the_shipped_mapping(measured):
    source = measured('rgblimp/data_1.csv.gz')
    draft = draft_mapping(source, {})
    shipped, _ = load_mapping('rgblimp')
    assert draft.choices.questions == []
    assert 'world: [x, -y, -z]\nbody: FRD' in draft.text
    assert 'time: {rate: 60 Hz}' in draft.text
    assert f'euler: {shipped.topics[0].orientation.euler}'.replace("'", '') in draft.text
