# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Logs that tools export: rows of several topics, doubled rows, poses as matrices, lists, counts.

Each is drafted from names and motion, imported, and compared with the flight that it was written
from; where nothing tells a reading, the draft asks or leaves it out.
"""

from collections.abc import Callable
from pathlib import Path

from lta_bag.reader import read_bag
from lta_config.errors import BadInput
from lta_data.bag.channels import read_flight
from lta_data.bag.recorded_flight import open_flight
from lta_data.bag.table import stack_components
from lta_data.data_quality.registry import run_checks
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.draft_mapping import draft_mapping
from lta_data.importers.draft.motion_draft import draft_motion, MotionDraft
from lta_data.interpretation.column_group import ColumnGroup, GEODETIC
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from scipy.spatial.transform import Rotation
import yaml

from .lab_flights import G, lab_flight, three, write_csv
from .test_log_conventions import (
    angles,
    Array,
    DEGREES,
    Flight,
    import_draft,
    in_ned,
    place,
    quaternion,
    timed,
    TO_NED,
    turned,
    world_velocity,
)


def draft_topics(source: Path, **answers: str) -> tuple[dict[str, object], list[str]]:
    """Return the entries of a draft by topic, and the keys of its questions."""
    draft = draft_mapping(source, answers)
    topics = {one['topic']: one for one in yaml.safe_load(draft.text)['topics']}
    return topics, [one.key for one in draft.choices.questions]


def check_flight(source: Path, f: Flight, folder: Path, **answers: str) -> None:
    """Import a log by its draft, and compare place and attitude with those that were flown."""
    draft = draft_mapping(source, answers)
    assert draft.choices.questions == []
    series = import_draft(draft, source, folder)
    rows = np.round((series.index - series.index[0]) / 0.02).astype(int)
    place = stack_components(series, 'pose.pose.position')
    np.testing.assert_allclose(place, f['p'][rows], atol=0.01)
    attitude = Rotation.from_quat(stack_components(series, 'pose.pose.orientation'))
    assert np.degrees((attitude.inv() * turned(f)[rows]).magnitude()).max() < 1.0


def interleave(first: dict[str, Array], second: dict[str, Array]) -> dict[str, Array]:
    """Return columns in which every other row has the numbers of one sensor alone."""
    count = len(next(iter(first.values())))
    out = {}
    for columns, offset in ((first, 0), (second, 1)):
        for name, values in columns.items():
            out[name] = np.full(2 * count, np.nan)
            out[name][offset::2] = values
    return out


def test_the_topics_of_one_table_may_have_rows_of_their_own(tmp_path: Path) -> None:
    """As PlotJuggler exports them; world to body attitudes need the gyroscope beside them."""
    f = lab_flight()
    sensed = three('/imu/angular_velocity/', f['w']) | three('/imu/linear_acceleration/', f['a'])
    pose = place(f, '/mocap/position/') | three(
        '/mocap/orientation/', f['q'] * [-1.0, -1.0, -1.0, 1.0], 'xyzw'
    )
    table = {'__time': np.sort(np.r_[f['t'], f['t'] + 0.004])} | interleave(pose, sensed)
    source = write_csv(tmp_path / 'log.csv', table)
    source.write_text(source.read_text().replace('nan', ''))
    check_flight(source, f, tmp_path)
    imu = open_flight(read_bag(tmp_path / 'out' / 'bag'), None)['imu']
    np.testing.assert_allclose(stack_components(imu, 'angular_velocity'), f['w'], atol=1e-4)


def test_rows_that_were_written_twice_have_one_time(tmp_path: Path) -> None:
    f = lab_flight()
    table = timed(f) | place(f) | quaternion(f)
    twice = {name: np.repeat(values, 2) for name, values in table.items()}
    check_flight(write_csv(tmp_path / 'log.csv', twice), f, tmp_path)


def test_rows_of_twelve_numbers_are_poses_as_matrices(tmp_path: Path) -> None:
    """As KITTI and evo write them."""
    f = lab_flight()
    rows = np.concatenate([turned(f).as_matrix(), f['p'][:, :, None]], axis=2).reshape(-1, 12)
    source = tmp_path / 'poses.txt'
    np.savetxt(source, rows, '%.9f')
    assert [one.key for one in draft_mapping(source, {}).choices.questions] == ['time.rate']
    check_flight(source, f, tmp_path, **{'time.rate': '50'})


@pytest.mark.parametrize('name', ['altitude (ft)', 'alt_ft'])
def test_an_altitude_may_be_in_feet_beside_metres(name: str, tmp_path: Path) -> None:
    f = lab_flight()
    table = timed(f, x=f['p'][:, 0], y=f['p'][:, 1]) | {name: f['p'][:, 2] / 0.3048}
    check_flight(write_csv(tmp_path / 'log.csv', table | quaternion(f)), f, tmp_path)


def test_of_two_altitudes_that_move_alike_one_is_taken(tmp_path: Path) -> None:
    f = lab_flight()
    fix = {'lat': 47.4 + f['p'][:, 1] / 111_182.0, 'lon': 8.5 + f['p'][:, 0] / 75_489.0}
    heights = {'alt_msl': f['p'][:, 2] + 408.0, 'alt_rel': f['p'][:, 2]}
    source = tmp_path / 'log.csv'
    table = timed(f) | fix | heights | quaternion(f)
    rows = zip(*(values.tolist() for values in table.values()), strict=True)
    source.write_text('\n'.join([','.join(table), *(','.join(map(repr, row)) for row in rows)]))
    f['p'] = f['p'] - f['p'][0]
    check_flight(source, f, tmp_path)


def quad_flight() -> Flight:
    """Return a figure of eight in which a rotorcraft leans towards its acceleration."""
    t = np.arange(0.0, 40.0, 0.02)
    p = np.column_stack(
        [1.5 * np.sin(0.8 * t), 0.8 * np.sin(1.6 * t), 1.2 + 0.2 * np.sin(0.4 * t)]
    )
    pull = np.gradient(np.gradient(p, t, axis=0), t, axis=0)
    lean = np.arctan2(pull, 9.80665)
    rpy = np.column_stack([-lean[:, 1], lean[:, 0], 0.02 * np.sin(0.1 * t)])
    return {'t': t, 'p': p, 'q': Rotation.from_euler('ZYX', rpy[:, ::-1]).as_quat(), 'rpy': rpy}


@pytest.mark.parametrize('signs', [(1, 1, 1), (1, -1, 1)])
def test_a_rotorcraft_accelerates_towards_its_tilt(signs: tuple[int, ...], tmp_path: Path) -> None:
    """The sign of its pitch needs no gyroscope."""
    f = quad_flight()
    source = write_csv(tmp_path / 'log.csv', timed(f) | place(f) | angles(f, signs=signs))
    check_flight(source, f, tmp_path)


def test_integers_of_a_crazyflie_are_in_millimetres(tmp_path: Path) -> None:
    f = lab_flight()
    names = 'stabilizer.roll stabilizer.pitch stabilizer.yaw'
    table = {'timestamp': np.round(1e3 * f['t']) + 99.0} | angles(f, names, (1, -1, 1))
    far = {**f, 'p': 4.0 * f['p']}  # 10 m in centimetres would be a flight, too
    table |= place(far, 'stateEstimateZ.', 1e3)
    check_flight(write_csv(tmp_path / 'log.csv', table), far, tmp_path)


def test_times_may_be_minutes_or_of_the_morning(tmp_path: Path) -> None:
    f = lab_flight()
    rest = place(f) | quaternion(f)
    clocks = {
        'time_min': [f'{one / 60.0:.9f}' for one in f['t']],
        'Time of day': [f'11:59:{one + 40.0:.3f} AM' if one < 20.0 else
                        f'12:00:{one - 20.0:06.3f} PM' for one in f['t']],
    }  # fmt: skip
    for name, cells in clocks.items():
        rows = zip(cells, *(map(repr, values.tolist()) for values in rest.values()), strict=True)
        source = tmp_path / f'{name}.csv'
        source.write_text('\n'.join([','.join([name, *rest]), *map(','.join, rows)]))
        folder = tmp_path / name
        folder.mkdir()
        check_flight(source, f, folder)


@pytest.mark.parametrize('first', [46_082.5, 739_678.5])
def test_days_are_refused_with_the_way_to_seconds(first: float, tmp_path: Path) -> None:
    f = lab_flight()
    days = [f'{first + one / 86_400.0:.12f}' for one in f['t']]
    rows = zip(days, *(map(repr, values.tolist()) for values in place(f).values()), strict=True)
    source = tmp_path / 'log.csv'
    source.write_text('\n'.join(['Time,x,y,z', *map(','.join, rows)]))
    with pytest.raises(BadInput, match=r"'Time' counts days .* by 86400"):
        draft_mapping(source, {})


def test_counts_of_a_gyroscope_are_scaled_by_the_attitude(tmp_path: Path) -> None:
    f = lab_flight()
    for factor, asked in ((1e3 * DEGREES, []), (65.5 * DEGREES, ['imu.rates.unit'])):
        sensed = three('gyro_', np.round(factor * f['w'])) | three('acc_', np.round(8192 * f['a']))
        source = write_csv(tmp_path / 'log.csv', timed(f) | place(f) | quaternion(f) | sensed)
        answers = dict.fromkeys(asked, 'counts')
        assert draft_topics(source)[1] == asked
        entry = draft_topics(source, **answers)[0]['imu']
        assert isinstance(entry, dict)
        assert entry['rates']['unit'] == 'rad/s'
        assert entry['rates']['scale'] * factor == pytest.approx(1.0, rel=0.01)
        # 8192 is gravity in counts, and no acceleration in mm/s2
        assert 'acceleration' not in entry


def test_counts_of_an_accelerometer_are_scaled_by_gravity(tmp_path: Path) -> None:
    f = lab_flight()
    sensed = three('acc_', np.round(4096 / G * f['a'])) | three('gyro_', f['w'])
    source = write_csv(tmp_path / 'log.csv', timed(f) | angles(f) | sensed)
    topics, asked = draft_topics(source)
    assert asked == []
    assert topics['imu']['acceleration']['scale'] == pytest.approx(G / 4096)  # type: ignore[index]


def test_rates_that_are_not_those_of_the_attitude_are_asked_about(tmp_path: Path) -> None:
    """EuRoC's b_w are the bias of a gyroscope."""
    f = lab_flight()
    drift = np.cumsum(np.random.default_rng(0).normal(0.0, 1e-6, f['w'].shape), axis=0)
    bias = three('b_w_RS_S_', drift + np.array([-0.002, 0.02, 0.07])) | three(
        'b_a_RS_S_', drift + 0.1
    )
    source = write_csv(tmp_path / 'log.csv', timed(f) | place(f) | quaternion(f) | bias)
    topics, asked = draft_topics(source)
    assert asked == ['ground_truth/odom.rates']
    assert [*topics] == ['ground_truth/odom']
    assert 'rates' not in topics['ground_truth/odom']  # type: ignore[operator]


def test_a_place_that_nobody_measured_and_a_covariance_are_left_out(tmp_path: Path) -> None:
    f = lab_flight()
    table = timed(f) | three('', 0.0 * f['p']) | angles(f) | three('gyro_', f['w'])
    table |= three('pose_covariance_', 1.0 + f['p'])
    topics, asked = draft_topics(write_csv(tmp_path / 'log.csv', table))
    assert 'position' not in topics['ground_truth/odom']  # type: ignore[operator]
    assert asked == ['world.up']
    assert 'odom' not in topics


def test_an_app_of_a_camera_drone_says_no_range_and_no_rotor(tmp_path: Path) -> None:
    f = lab_flight()
    table = timed(
        f, latitude=48.0 + f['p'][:, 1] / 111_200, longitude=11.5 + f['p'][:, 0] / 74_500
    )
    table |= {
        'height_above_takeoff(feet)': f['p'][:, 2] / 0.3048,
        'altitude_above_seaLevel(feet)': (500.0 + f['p'][:, 2]) / 0.3048,
        'speed(mph)': np.abs(f['v'][:, 0]) / 0.44704,
        'compass_heading(degrees)': (90.0 - DEGREES * f['rpy'][:, 2]) % 360.0,
        'pitch(degrees)': -DEGREES * f['rpy'][:, 1],
        'roll(degrees)': DEGREES * f['rpy'][:, 0],
    }
    topics, asked = draft_topics(write_csv(tmp_path / 'log.csv', table))
    assert asked == []
    assert [*topics] == ['ground_truth/odom']
    entry = topics['ground_truth/odom']
    assert entry['position']['scale'] == [1.0, 1.0, 0.3048]  # type: ignore[index]
    assert entry['orientation']['signs'] == [-1, -1, 1]  # type: ignore[index]


def test_the_frame_of_a_velocity_without_a_position_is_that_in_which_it_moves_ahead(
    tmp_path: Path,
) -> None:
    f = lab_flight()
    for frame, speed in (('world', world_velocity(f)), ('body', f['v'])):
        sensed = three('linear_acceleration_', f['a']) | three('angular_velocity_', f['w'])
        table = timed(f) | quaternion(f) | three('linear_velocity_', speed) | sensed
        topics, asked = draft_topics(write_csv(tmp_path / 'log.csv', table))
        assert asked == []
        velocity = topics['ground_truth/odom']['velocity']  # type: ignore[index]
        assert velocity.get('frame', 'body') == frame


@pytest.mark.parametrize(
    ('name', 'unit', 'asked'),
    [
        ('tof', 'mm', ['range.range.unit']),
        ('tof [cm]', 'cm', []),
        ('range.zrange', 'mm', []),
    ],
)
def test_a_range_can_be_in_mm_or_cm(
    tmp_path: Path, name: str, unit: str, asked: list[str]
) -> None:
    f = lab_flight()
    table = timed(f) | place(f) | quaternion(f) | {name: 150.0 + 10.0 * np.sin(f['t'])}
    topics, questions = draft_topics(write_csv(tmp_path / 'log.csv', table))
    assert topics['range']['range'] == {'column': name, 'unit': unit}  # type: ignore[index]
    assert questions == asked


def test_angles_in_hundredths_of_a_degree_are_left_out(tmp_path: Path) -> None:
    f = lab_flight()
    table = timed(f) | place(f) | angles(f, scale=100.0 * DEGREES)
    topics, _ = draft_topics(write_csv(tmp_path / 'log.csv', table))
    assert [*topics['ground_truth/odom']] == ['topic', 'position']  # type: ignore[misc]


def test_duties_and_thrusts_of_the_same_rotors_are_asked_about(tmp_path: Path) -> None:
    f = lab_flight()
    duty = 0.5 + 0.4 * np.sin(np.outer(f['t'], [0.3, 0.4]))
    table = timed(f) | place(f) | quaternion(f)
    table |= {f'm{k + 1}': np.round(65_535 * duty[:, k]) for k in range(2)}
    table |= {f'thrust{k + 1}_g': 15.0 * duty[:, k] for k in range(2)}
    source = write_csv(tmp_path / 'log.csv', table)
    topics, asked = draft_topics(source)
    assert asked == ['motors.columns']
    assert topics['motors']['actuators'] == {  # type: ignore[index]
        f'm{k}': {'effort': {'column': f'm{k}', 'over': 65535}} for k in (1, 2)
    }
    topics, _ = draft_topics(source, **{'motors.columns': 'thrust1_g'})
    (first, _) = topics['motors']['actuators'].values()  # type: ignore[index]
    assert first == {'effort': {'column': 'thrust1_g', 'unit': 'N', 'scale': 0.00980665}}


def test_servos_in_degrees_stand_beside_motors(tmp_path: Path) -> None:
    f = lab_flight()
    table = timed(f) | place(f) | quaternion(f)
    table |= {'servo1_deg': 90.0 + 30.0 * np.sin(f['t']), 'motor_left': 0.5 + 0.4 * np.sin(f['t'])}
    topics, asked = draft_topics(write_csv(tmp_path / 'log.csv', table))
    assert asked == []
    assert topics['motors']['actuators'] == {  # type: ignore[index]
        'left': {'effort': {'column': 'motor_left'}},
        'servo1_deg': {'position': {'column': 'servo1_deg', 'unit': 'deg'}},
    }


def test_lists_and_structs_of_a_parquet_table_are_columns(tmp_path: Path) -> None:
    f = lab_flight()
    pose = [{'position': p, 'orientation': q}
            for p, q in zip(f['p'].tolist(), f['q'].tolist(), strict=True)]  # fmt: skip
    source = tmp_path / 'log.data'  # its content says what it is
    pq.write_table(pa.table({'t': f['t'], 'pose': pose}), source)
    check_flight(source, f, tmp_path)


def test_a_place_and_an_attitude_in_two_tables_become_one_pose(tmp_path: Path) -> None:
    """As PX4's topics are exported; the attitude turns by 0.01 rad in the age of its rows."""
    f = lab_flight()
    folder = tmp_path / 'log'
    folder.mkdir()
    motion = three('', f['p'] @ TO_NED.T) | three('v', world_velocity(f) @ TO_NED.T)
    write_csv(folder / 'vehicle_local_position_0.csv', timed(f) | motion)
    write_csv(folder / 'attitude_0.csv', {'t': f['t'] - 0.004, **three('q', in_ned(f), 'xyzw')})
    topics, asked = draft_topics(folder)
    assert asked == []
    assert topics['ground_truth/odom']['join'] == ['attitude_0']  # type: ignore[index]
    check_flight(folder, f, tmp_path)


def write_tables(folder: Path, f: Flight, **other: Array) -> Path:
    """Write places and other columns as two tables of a folder."""
    folder.mkdir()
    write_csv(folder / 'mocap.csv', timed(f) | place(f))
    write_csv(folder / 'attitude.csv', other)
    return folder


@pytest.mark.parametrize(
    'clock',
    [
        lambda t: t + 1_000.0,
        lambda t: 1e3 * t,
        lambda t: 0.5 * t,  # ends early
    ],
    ids=['other', 'ms', 'ends'],
)
def test_tables_on_other_clocks_stay_apart(
    clock: Callable[[Array], Array], tmp_path: Path
) -> None:
    f = lab_flight()
    source = write_tables(tmp_path / 'log', f, t=clock(f['t']), **quaternion(f))
    draft = draft_mapping(source, {})
    assert 'join' not in draft.text
    assert 'position' in draft.text  # worth more than an attitude alone
    left = {one.reading for one in draft.choices.reasons if 'same times' in one.reason}
    assert left == {'left out'}


def test_an_attitude_stays_beside_the_rates_that_tell_how_to_read_it(tmp_path: Path) -> None:
    f = lab_flight()
    imu = {'t': f['t'], **quaternion(f), **three('gyro_', f['w']), **three('acc_', f['a'])}
    assert 'join' not in draft_mapping(write_tables(tmp_path / 'log', f, **imu), {}).text


@pytest.mark.parametrize('name', ['vehicle_odometry_0', 'log_3_vehicle_local_position'])
@pytest.mark.parametrize('has_attitude', [False, True])
def test_heights_above_a_floor_contradict_the_name_of_a_table(
    name: str, has_attitude: bool, tmp_path: Path
) -> None:
    f = lab_flight()
    folder = tmp_path / 'log'
    folder.mkdir()
    write_csv(folder / 'battery.csv', timed(f, voltage=np.full(len(f['t']), 3.9)))
    table = timed(f) | place(f) | three('v', world_velocity(f))
    write_csv(folder / f'{name}.csv', table | (quaternion(f) if has_attitude else {}))
    assert draft_topics(folder)[1] == ['world.up']
    (folder / f'{name}.csv').rename(folder / f'{name}_enu.csv')
    assert draft_topics(folder)[1] == []


@pytest.mark.parametrize(('name', 'cells'), [
    ('exposure', ['5 ms'] * 1500), ('latency', [f'{k + 1} ms' for k in range(1500)]),
    ('battery_left', [f'{9 - k // 600:02}:{59 - k // 10 % 60:02}.{9 - k % 10}'
                      for k in range(1500)]),
])  # fmt: skip
def test_a_duration_is_no_time_beside_a_column_of_times(
    name: str, cells: list[str], tmp_path: Path
) -> None:
    f = lab_flight()
    source = write_csv(tmp_path / 'log.csv', timed(f) | place(f) | quaternion(f))
    lines = source.read_text().splitlines()
    source.write_text('\n'.join(
        f'{cell},{line}' for cell, line in zip([name, *cells], lines, strict=True)
    ))  # fmt: skip
    check_flight(source, f, tmp_path)


def test_durations_are_the_time_without_another(tmp_path: Path) -> None:
    f = lab_flight()
    source = write_csv(tmp_path / 'log.csv', timed(f) | place(f) | quaternion(f))
    head, *rows = source.read_text().splitlines()
    cells = [row.partition(',') for row in rows]
    source.write_text('\n'.join([head, *(f'{one[0]} sec,{one[2]}' for one in cells)]))
    check_flight(source, f, tmp_path)
    readings = {one.reading for one in draft_mapping(source, {}).choices.reasons}
    assert 'durations' in readings
    assert 'dates' not in readings


def draft_place(seconds: Array, place_: Array) -> MotionDraft:
    """Return the draft of positions in mm."""
    group = ColumnGroup('position', '', ('x', 'y', 'z'), ('x', 'y', 'z'), 'mm', '')
    groups, numbers = {'position': group}, {'position': place_}
    return draft_motion('ground_truth/odom', seconds, groups, numbers, DraftChoices({}))


def test_a_smooth_flight_in_millimetres_has_no_jumps() -> None:
    seconds = np.arange(0.0, 60.0, 0.01)
    place_mm = 1000.0 * np.stack(
        [np.cos(seconds), np.sin(2.0 * seconds), 1.0 + 0.3 * np.sin(0.5 * seconds)], axis=1
    )
    place_mm[3000] += 5.0  # noise that is no jump
    found = draft_place(seconds, place_mm).evidence.position
    assert found is not None
    np.testing.assert_allclose(found, 1e-3 * place_mm, rtol=1e-12)


def test_a_jump_of_a_tracker_is_left_out_where_the_time_steps_back() -> None:
    seconds = np.arange(0.0, 60.0, 0.01)
    place_mm = 1000.0 * np.stack([np.cos(0.3 * seconds), np.sin(0.3 * seconds), seconds**0], 1)
    jumped = place_mm.copy()
    jumped[900:910] += 800.0
    seconds[1000:] -= 5.0
    found = draft_place(seconds, jumped).evidence.position
    assert found is not None
    np.testing.assert_allclose(found, 1e-3 * place_mm, atol=1e-3)


@pytest.mark.parametrize('seed', range(10))
def test_a_velocity_beside_a_fix_is_north_east_down_only_if_that_is_clear(seed: int) -> None:
    """On a way to the north-east both orders fit, and noise must not decide."""
    rng = np.random.default_rng(seed)
    seconds = np.arange(0.0, 30.0, 0.02)
    speed = np.outer(1.0 + np.sin(seconds), [1.0, 1.0, 0.0])
    fix = np.cumsum(0.02 * speed, axis=0) + rng.normal(0.0, 0.005, speed.shape)
    columns = ('lat', 'lon', 'alt')
    groups = {
        'position': ColumnGroup('position', '', columns, GEODETIC, 'm', ''),
        'velocity': ColumnGroup('velocity', '', ('vx', 'vy', 'vz'), ('x', 'y', 'z'), '', ''),
    }
    numbers = {'position': fix, 'velocity': speed + rng.normal(0.0, 0.05, speed.shape)}
    turn = Rotation.from_rotvec(np.outer(0.1 * seconds, [0.0, 0.0, 1.0]))
    found = draft_motion('ground_truth/odom', seconds, groups, numbers, DraftChoices({}), turn)
    assert found.parts['velocity']['columns'] == ['vx', 'vy', 'vz']


def test_what_is_known_beside_an_unknown_part_is_judged(tmp_path: Path) -> None:
    """The first covariance of a pose or twist says that of its linear components alone."""
    f = lab_flight()
    # As central differences have it, which once showed a drift
    f['w'][[0, -1]] = 0.0
    for name, table in {
        'attitude': timed(f) | quaternion(f), 'rates': timed(f) | place(f) | three('w', f['w']),
    }.items():  # fmt: skip
        source = write_csv(tmp_path / f'{name}.csv', table | quaternion(f))
        draft = draft_mapping(source, {'world.up': 'up'} if name == 'attitude' else {})
        folder = tmp_path / name
        folder.mkdir()
        import_draft(draft, source, folder)
        flight = read_flight(open_flight(read_bag(folder / 'out' / 'bag'), None), raw=True)
        report = run_checks(flight)
        assert not report.is_grave
        assert name in ' '.join(report.judged)


def test_json_is_refused_with_the_remedy(tmp_path: Path) -> None:
    source = tmp_path / 'log.jsonl'
    source.write_text('{"t": 0.0, "x": 1.0}\n{"t": 0.1, "x": 1.1}\n')
    with pytest.raises(BadInput, match=r'is JSON; write it as a table'):
        draft_mapping(source, {})


def test_a_velocity_in_world_axes_says_the_unit_of_feet(tmp_path: Path) -> None:
    f = lab_flight()
    feet = {f'{axis} [ft]': f['p'][:, k] / 0.3048 for k, axis in enumerate('xyz')}
    table = timed(f) | feet | quaternion(f) | three('v', world_velocity(f))
    check_flight(write_csv(tmp_path / 'log.csv', table), f, tmp_path)
