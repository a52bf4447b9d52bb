# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A log in any convention comes to the flight that it was written from, or is asked about.

Each form is drafted from names and motion alone, imported with the draft, and compared with the
truth: place, attitude, body velocity and body rates.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from lta_bag.reader import read_bag
from lta_data.bag.recorded_flight import open_flight
from lta_data.bag.table import stack_components
from lta_data.importers.draft.draft_mapping import draft_mapping, MappingDraft
from lta_data.importers.run import import_logs, ImportRequest
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation
import yaml

from .lab_flights import DOWN, lab_flight, three, write_csv

Array = NDArray[np.float64]
Flight = dict[str, Array]
DEGREES = 180.0 / np.pi
EPOCH = 1_700_000_000  # s
TO_NED = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


class Form(NamedTuple):
    """How a log is written, and which parts of the flight it has."""

    write: Callable[[Flight], dict[str, Array]]
    parts: str = 'pq'
    others: frozenset[str] | None = None  # topics beside the motion; None for any


def turned(f: Flight) -> Rotation:
    return Rotation.from_quat(f['q'])


def world_velocity(f: Flight) -> Array:
    return np.asarray(turned(f).apply(f['v']))


def timed(f: Flight, **columns: Array) -> dict[str, Array]:
    return {'t': f['t'], **columns}


def place(f: Flight, name: str = '', scale: float = 1.0) -> dict[str, Array]:
    return three(name, scale * f['p'])


def angles(f: Flight, names: str = 'roll pitch yaw', signs: tuple[int, ...] = (1, 1, 1),
           scale: float = DEGREES) -> dict[str, Array]:  # fmt: skip
    return {n: s * scale * one for n, s, one in zip(names.split(), signs, f['rpy'].T, strict=True)}


def quaternion(f: Flight, name: str = 'q', order: str = 'xyzw') -> dict[str, Array]:
    return {f'{name}{axis}': f['q'][:, 'xyzw'.index(axis)] for axis in order}


def compass(f: Flight) -> Array:
    return np.asarray((90.0 - DEGREES * f['rpy'][:, 2]) % 360.0)


def whole_and_rest(f: Flight, per_second: int, names: tuple[str, str]) -> dict[str, Array]:
    count = np.round((f['t'] + EPOCH) * per_second).astype(np.int64)
    return {names[0]: count // per_second, names[1]: count % per_second}


def in_ned(f: Flight) -> Array:
    return Rotation.from_matrix(TO_NED @ turned(f).as_matrix() @ np.diag(DOWN)).as_quat()


def crazyflie(f: Flight) -> dict[str, Array]:
    names = 'stabilizer.roll stabilizer.pitch stabilizer.yaw'
    time = {'timestamp': np.round(1e3 * f['t']) + 99.0}
    return time | place(f, 'stateEstimate.') | angles(f, names, (1, -1, 1))


ERRORS = ('x_error', 'y_error', 'z_error', 'height_error', 'altitude_error', 'motor_error')
TRAVEL_SPEEDS = (
    'ground_speed', 'gps_speed', 'gps_0_speed', 'air_speed', 'wind_speed', 'vertical_speed',
    'speed',
)  # fmt: skip
FORMS = {
    # A sign of an angle
    'Crazyflie names alone': Form(crazyflie),
    'Crazyflie with its gyroscope': Form(
        lambda f: crazyflie(f) | three('gyro.', DEGREES * f['w']) | three('acc.', f['a'] / 9.81)
    ),
    'Crazyflie with compressed states': Form(
        lambda f: {'timestamp': np.round(1e3 * f['t']) + 99.0}
        | place(f, 'stateEstimateZ.', 1e3) | three('stateEstimateZ.v', 1e3 * world_velocity(f))
        | angles(f, 'stabilizer.roll stabilizer.pitch stabilizer.yaw', (1, -1, 1))
        | dict(zip(('stateEstimateZ.rateRoll', 'stateEstimateZ.ratePitch',
                    'stateEstimateZ.rateYaw'), 1e3 * f['w'].T, strict=True)), 'pqvw',
    ),
    'Crazyflie with the compressed states of its firmware, whose rates are inverted, too': Form(
        lambda f: {'timestamp': np.round(1e3 * f['t']) + 99.0}
        | place(f, 'stateEstimateZ.', 1e3) | three('stateEstimateZ.v', 1e3 * world_velocity(f))
        | angles(f, 'stateEstimate.roll stateEstimate.pitch stateEstimate.yaw', (1, -1, 1))
        | dict(zip(('stateEstimateZ.rateRoll', 'stateEstimateZ.ratePitch',
                    'stateEstimateZ.rateYaw'), 1e3 * (f['w'] * [1, -1, 1]).T, strict=True)),
        'pqvw',
    ),
    'pitch inverted, by the gyroscope': Form(
        lambda f: timed(f) | place(f) | angles(f, signs=(1, -1, 1)) | three('w', f['w']), 'pqw'
    ),
    'pitch inverted, by the accelerometer': Form(
        lambda f: timed(f) | place(f, scale=1e3) | angles(f, 'phi theta psi', (1, -1, 1), 1.0)
        | three('acc_', f['a'] / 9.80665)
    ),
    'yaw inverted, by the gyroscope': Form(
        lambda f: timed(f) | place(f) | angles(f, signs=(1, 1, -1)) | three('omega_', f['w']),
        'pqw',
    ),
    'pitch inverted, by the body velocity': Form(
        lambda f: timed(f) | place(f) | angles(f, signs=(1, -1, 1)) | three('v', f['v']), 'pqv'
    ),
    'a compass heading over east and north': Form(
        lambda f: timed(f, east=f['p'][:, 0], north=f['p'][:, 1], altitude=f['p'][:, 2],
                        heading=compass(f), roll=f['rpy'][:, 0] * DEGREES,
                        pitch=f['rpy'][:, 1] * DEGREES)
    ),
    'x_dot and phi_dot': Form(
        lambda f: timed(f) | place(f) | angles(f, 'phi theta psi', scale=1.0)
        | three('', world_velocity(f), ('x_dot', 'y_dot', 'z_dot'))
        | three('', f['w'], ('phi_dot', 'theta_dot', 'psi_dot')), 'pqvw',
    ),
    'a pose as a matrix': Form(
        lambda f: timed(f) | {f'T{i}{j}': turned(f).as_matrix()[:, i, j]
                              for i in range(3) for j in range(3)}
        | {f'T{i}3': f['p'][:, i] for i in range(3)}
        | {f'T3{j}': np.full(len(f['t']), float(j == 3)) for j in range(4)}
    ),
    'a tracking error beside': Form(
        lambda f: timed(f) | place(f, 'pos_') | quaternion(f, 'attq_')
        | three('pos_error_', np.sin(f['p'])) | three('error_', np.cos(f['p']))
        | quaternion({**f, 'q': f['q'] * 0.0 + [0.0, 0.0, 0.0, 1.0]}, 'q_error_')
    ),
    'errors of what sensors and controllers have': Form(
        lambda f: timed(f) | place(f) | quaternion(f) | three('', 0.1 * np.cos(f['p']), ERRORS[:3])
        | {name: 0.5 + 0.1 * np.sin(f['t']) for name in ERRORS[3:]}
        | {'voltage_error': 12.0 + np.sin(f['t'])}, others=frozenset(),
    ),
    'the error of a heading beside a place': Form(
        lambda f: timed(f) | place(f) | quaternion(f) | {'yaw_error': 0.1 * np.sin(f['t'])}
        | three('euler_error_', np.sin(f['p'])), others=frozenset(),
    ),
    'speeds of the vehicle, not of its rotors': Form(
        lambda f: timed(f) | place(f) | quaternion(f)
        | dict.fromkeys(TRAVEL_SPEEDS, f['v'][:, 0]),
        others=frozenset(),
    ),
    'speeds of rotors': Form(
        lambda f: timed(f) | place(f) | quaternion(f)
        | dict.fromkeys(('left_speed', 'port_speed', 'speed_fl'), 300.0 + 10.0 * f['v'][:, 0]),
        others=frozenset(['motors']),
    ),
    # Angles, rates and velocities by other names
    'German': Form(lambda f: timed(f) | place(f)
                   | angles(f, 'Rollwinkel Nickwinkel Gierwinkel')),
    'ang_vel': Form(
        lambda f: timed(f) | place(f) | quaternion(f) | three('ang_vel_', f['w']), 'pqw'
    ),
    'angular speed in degrees': Form(
        lambda f: timed(f) | place(f) | angles(f)
        | three('AngularVelocity', DEGREES * f['w'], 'XYZ'), 'pqw',
    ),
    'rollrate': Form(
        lambda f: timed(f) | place(f) | angles(f)
        | dict(zip(('rollrate', 'pitchrate', 'yawrate'), f['w'].T, strict=True)), 'pqw',
    ),
    'rates in the world': Form(
        lambda f: timed(f) | place(f) | quaternion(f) | three('omega_', turned(f).apply(f['w'])),
        'pqw',
    ),
    'names that say nothing': Form(
        lambda f: timed(f) | place(f) | quaternion(f) | three('foo_', f['w'])
        | three('bar_', world_velocity(f)), 'pqvw',
    ),
    'p, q, r for angles': Form(
        lambda f: timed(f) | place(f) | dict(zip('pqr', f['rpy'].T, strict=True)), 'pq'
    ),
    # Frames and units
    'a state vector': Form(
        lambda f: timed(f) | place(f) | angles(f, 'phi theta psi', scale=1.0)
        | dict(zip('uvw', f['v'].T, strict=True)) | dict(zip('pqr', f['w'].T, strict=True)),
        'pqvw',
    ),
    'a state vector in capitals, another order': Form(
        lambda f: dict(zip('PQR', f['w'].T, strict=True)) | dict(zip('UVW', f['v'].T, strict=True))
        | angles(f, 'PHI THETA PSI', scale=1.0) | place(f) | {'T': f['t']}, 'pqvw',
    ),
    'a state vector with units': Form(
        lambda f: timed(f) | place(f) | angles(f, 'phi_rad theta_rad psi_rad', scale=1.0)
        | dict(zip(('u_m_s', 'v_m_s', 'w_m_s'), f['v'].T, strict=True))
        | dict(zip(('p_rad_s', 'q_rad_s', 'r_rad_s'), f['w'].T, strict=True)), 'pqvw',
    ),
    'u, v, w in the world': Form(
        lambda f: timed(f) | place(f) | quaternion(f)
        | dict(zip('uvw', world_velocity(f).T, strict=True)), 'pqv',
    ),
    'body velocity in mm/s': Form(
        lambda f: timed(f) | place(f, scale=1e3) | quaternion(f, order='wxyz')
        | three('v', 1e3 * f['v']), 'pqv',
    ),
    'x and y beside an altitude': Form(
        lambda f: timed(f, x=f['p'][:, 0], y=f['p'][:, 1], alt=f['p'][:, 2]) | quaternion(f)
    ),
    'a state vector without names': Form(
        lambda f: timed(f) | {f'x{k + 1}': one for k, one in enumerate(
            np.hstack([f['p'], f['rpy'], f['v'], f['w']]).T)}, 'pqvw',
    ),
    'xdot, in another order': Form(
        lambda f: timed(f) | angles(f, scale=1.0) | place(f)
        | dict(zip(('xdot', 'ydot', 'zdot'), world_velocity(f).T, strict=True)), 'pqv',
    ),
    'north, east, down': Form(
        lambda f: timed(f, **three('p', f['p'] @ TO_NED.T, 'ned'),
                        **three('v', world_velocity(f) @ TO_NED.T, 'ned'),
                        **three('q', in_ned(f)[:, [3, 0, 1, 2]], '0123'),
                        **three('w', f['w'] * DOWN)), 'pqvw',
    ),
    'a velocity north, east, down without a place': Form(
        lambda f: timed(f, **three('vel_', world_velocity(f) @ TO_NED.T, 'ned'),
                        **three('q', in_ned(f), 'xyzw')), 'qv', others=frozenset(),
    ),
    'a place north, east, down beside an attitude in our axes': Form(
        lambda f: timed(f, **three('', f['p'] @ TO_NED.T, 'ned')) | angles(f)
        | dict(zip('pqr', f['w'].T, strict=True)), 'pqw',
    ),
    'from the world to the body': Form(
        lambda f: timed(f) | place(f) | three('q', f['q'] * [-1.0, -1.0, -1.0, 1.0], 'xyzw')
        | three('v', f['v']) | three('w', f['w']), 'pqvw',
    ),
    "a quaternion whose w stands alone, as vicon_receiver's": Form(
        lambda f: timed(f) | dict(zip(('x_trans', 'y_trans', 'z_trans'), 1e3 * f['p'].T,
                                      strict=True))
        | dict(zip(('x_rot', 'y_rot', 'z_rot', 'w'), f['q'].T, strict=True))
    ),
    'a compass heading beside a pitch with our sign, by the body velocity': Form(
        lambda f: timed(f, heading=compass(f), roll=f['rpy'][:, 0] * DEGREES,
                        pitch=f['rpy'][:, 1] * DEGREES)
        | place(f) | dict(zip('uvw', f['v'].T, strict=True)), 'pqv',
    ),
    # Names of a body before those of quantities
    'letters behind a name': Form(
        lambda f: timed(f) | place(f, 'blimp_p') | quaternion(f, 'blimp_q')
        | dict(zip(('blimp_u', 'blimp_v', 'blimp_w'), f['v'].T, strict=True)), 'pqv',
        others=frozenset(),
    ),
    'north, east, down behind a name': Form(
        lambda f: timed(f) | quaternion({**f, 'q': in_ned(f)}, 'drone_rot_')
        | three('drone_', f['p'] @ TO_NED.T, ('north', 'east', 'down')), others=frozenset(),
    ),
    'x, y, z behind the name of an attitude': Form(
        lambda f: timed(f) | place(f, 'state.') | quaternion(f, 'state.rot_')
    ),
    'a place named tx_m': Form(
        lambda f: timed(f) | quaternion(f, 'rot_') | three('t', f['p'], ('x_m', 'y_m', 'z_m')),
        others=frozenset(),
    ),
    'how well each is known': Form(
        lambda f: timed(f) | place(f) | quaternion(f)
        | dict.fromkeys(('x_std', 'pos_sigma_x', 'position_uncertainty'), 0.01 + 0.0 * f['t']),
        others=frozenset(),
    ),
    # Times
    'no time beside a velocity': Form(
        lambda f: place(f, 'p') | quaternion(f) | three('v', f['v']), 'pqv'
    ),
    'seconds and nanoseconds': Form(
        lambda f: whole_and_rest(f, 10**9, ('stamp.sec', 'stamp.nanosec')) | place(f)
        | quaternion(f)
    ),
    'tv_sec and tv_usec': Form(
        lambda f: quaternion(f) | place(f) | whole_and_rest(f, 10**6, ('tv_sec', 'tv_usec'))
    ),
    # Bodies
    'a still body before the vehicle': Form(
        lambda f: timed(f) | three('wand_', np.ones_like(f['p']))
        | {f'wand_q{a}': np.full(len(f['t']), float(a == 'w')) for a in 'xyzw'}
        | place(f, 'drone_') | quaternion(f, 'drone_q')
    ),
}  # fmt: skip


def write_form(form: Form, path: Path) -> tuple[Flight, Path]:
    f = lab_flight()
    lines = form.write(f)
    names = list(lines)
    rows = zip(*(lines[name].tolist() for name in names), strict=True)
    text = [','.join(names), *(','.join(map(repr, row)) for row in rows)]
    path.write_text('\n'.join(text) + '\n')
    return f, path


def import_draft(draft: MappingDraft, source: Path, folder: Path) -> Any:
    mapping = folder / 'mapping.yaml'
    mapping.write_text(draft.text)
    import_logs(ImportRequest([source], str(mapping)), folder / 'out')
    flight = open_flight(read_bag(folder / 'out' / 'bag'), None)
    topic = next(one for one in ('ground_truth/odom', 'odom') if one in flight.topics)
    return flight[topic]


@pytest.mark.parametrize('form', FORMS.values(), ids=FORMS)
def test_a_log_in_any_convention_is_read_as_it_was_written(form: Form, tmp_path: Path) -> None:
    f, source = write_form(form, tmp_path / 'log.csv')
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    series = import_draft(draft, source, tmp_path)
    np.testing.assert_allclose(np.ptp(series.index), np.ptp(f['t']), atol=1e-3)
    if form.others is not None:
        topics = {entry['topic'] for entry in yaml.safe_load(draft.text)['topics']}
        assert topics - {'ground_truth/odom'} == form.others
    if 'p' in form.parts:
        np.testing.assert_allclose(
            stack_components(series, 'pose.pose.position'), f['p'], atol=0.01
        )
    attitude = Rotation.from_quat(stack_components(series, 'pose.pose.orientation'))
    assert np.degrees((attitude.inv() * turned(f)).magnitude()).max() < 1.0
    if 'v' in form.parts:
        np.testing.assert_allclose(
            stack_components(series, 'twist.twist.linear'), f['v'], atol=0.01
        )
    if 'w' in form.parts:
        np.testing.assert_allclose(
            stack_components(series, 'twist.twist.angular'), f['w'], atol=0.02
        )


def drift() -> Flight:
    """Return a flight that turns by a radian while it drifts straight to the right."""
    t = np.arange(0.0, 24.0, 0.02)
    rpy = np.column_stack([0.04 * np.sin(1.7 * t), 0.05 * np.sin(1.1 * t), 1.2 * np.sin(0.3 * t)])
    p = np.column_stack([0.05 * np.sin(0.5 * t), -0.4 * t, 1.5 + 0.1 * np.sin(0.2 * t)])
    return {'t': t, 'p': p, 'q': Rotation.from_euler('ZYX', rpy[:, ::-1]).as_quat(), 'rpy': rpy}


def turn_late() -> Flight:
    """Return a flight along its heading, 180 degrees, that then drifts on while it turns."""
    f = drift()
    t = f['t']
    p = np.column_stack([-0.4 * t, 0.1 * np.sin(0.2 * t), f['p'][:, 2]])
    yaw = np.pi - 2.0 / (1.0 + np.exp(-2.0 * (t - 20.0)))
    rpy = np.column_stack([f['rpy'][:, :2], yaw])
    return {'t': t, 'p': p, 'q': Rotation.from_euler('ZYX', rpy[:, ::-1]).as_quat(), 'rpy': rpy}


@pytest.mark.parametrize(
    ('f', 'columns'),
    [
        (drift(), quaternion(drift())),
        (drift(), angles(drift(), scale=1.0)),
        (turn_late(), quaternion(turn_late())),
    ],
    ids=['quaternion', 'radians', 'late turn'],
)
def test_a_flight_that_drifts_contradicts_no_names(
    f: Flight, columns: dict[str, Array], tmp_path: Path
) -> None:
    """Another order of the elements, or degrees, would let it move straight ahead."""
    source = write_csv(tmp_path / 'log.csv', timed(f) | place(f) | columns)
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    attitude = Rotation.from_quat(
        stack_components(import_draft(draft, source, tmp_path), 'pose.pose.orientation')
    )
    assert np.degrees((attitude.inv() * turned(f)).magnitude()).max() < 1.0


def test_bodies_in_turn_are_told_apart_also_by_places_behind_a_name(tmp_path: Path) -> None:
    f = lab_flight()
    columns = three('drone_', f['p'] @ TO_NED.T, ('north', 'east', 'down'))
    columns |= quaternion({**f, 'q': in_ned(f)}, 'drone_q')
    rows = ['t,body,' + ','.join(columns)]
    for k, time in enumerate(f['t']):
        for body, row in (('blimp', k), ('wand', 0)):
            cells = ','.join(f'{one[row]:.9g}' for one in columns.values())
            rows.append(f'{time:.9g},{body},{cells}')
    source = tmp_path / 'log.csv'
    source.write_text('\n'.join(rows) + '\n')
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    assert [one.reading for one in draft.choices.reasons if one.part == 'body'] == ['blimp']


def test_missing_cells_of_an_attitude_do_not_contradict_its_rates(tmp_path: Path) -> None:
    f = lab_flight()
    gone = np.random.default_rng(3).random(len(f['t'])) < 0.01
    cells = {name: np.where(gone, np.nan, one) for name, one in quaternion(f).items()}
    source = write_csv(tmp_path / 'log.csv', timed(f) | place(f) | cells | three('w', f['w']))
    assert draft_mapping(source, {}).choices.questions == []


def test_a_log_that_ends_within_its_last_time_is_read_by_its_times(tmp_path: Path) -> None:
    f = lab_flight()
    source = write_csv(tmp_path / 'log.csv', place(f) | quaternion(f) | timed(f))
    source.write_bytes(source.read_bytes()[:-4])
    draft = draft_mapping(source, {})
    assert yaml.safe_load(draft.text)['time']['column'] == 't'


def test_arrays_of_one_length_are_one_table_whatever_their_names(tmp_path: Path) -> None:
    f = lab_flight()
    source = tmp_path / 'log.npz'
    np.savez(source, **timed(f), **place(f, 'position.'), **quaternion(f, 'orientation.'))
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    series = import_draft(draft, source, tmp_path)
    np.testing.assert_allclose(stack_components(series, 'pose.pose.position'), f['p'], atol=0.01)


def hover() -> Flight:
    """Return a flight that stays within 0.3 m and hardly turns."""
    t = np.arange(0.0, 40.0, 0.02)
    rng = np.random.default_rng(8)
    rpy = np.column_stack([0.04 * np.sin(1.7 * t), 0.05 * np.sin(1.1 * t), 0.4 * np.sin(0.2 * t)])
    p = np.column_stack([0.14 * np.sin(0.5 * t), 0.12 * np.sin(0.4 * t), 1.2 + 0.1 * np.sin(t)])
    turn = Rotation.from_euler('ZYX', rpy[:, ::-1])
    pull = np.gradient(np.gradient(p, t, axis=0), t, axis=0) + np.array([0.0, 0.0, 9.80665])
    force = turn.inv().apply(pull) + rng.normal(0.0, 0.03, p.shape)
    return {'t': t, 'p': p, 'q': turn.as_quat(), 'rpy': rpy, 'a': force}


def test_a_hover_shows_an_inverted_pitch_to_the_accelerometer(tmp_path: Path) -> None:
    f = hover()
    table = timed(f) | place(f) | angles(f, signs=(1, -1, 1)) | three('acc_', f['a'])
    draft = draft_mapping(write_csv(tmp_path / 'log.csv', table), {})
    assert draft.choices.questions == []
    assert 'signs: [1, -1, 1]' in draft.text


def test_a_unit_in_which_a_hover_would_be_a_flight_is_asked(tmp_path: Path) -> None:
    f = hover()
    table = timed(f) | place(f, scale=1e3) | quaternion(f)
    (question,) = draft_mapping(write_csv(tmp_path / 'log.csv', table), {}).choices.questions
    assert [name for name, _ in question.options] == ['cm', 'mm']


@pytest.mark.parametrize(('scale', 'gyro'), [
    (1.0, 'gyro_'), (DEGREES, 'gyro_'), (1.0, 'g'), (1.0, 'gyro_no_bias_'),
    (1.0, 'gyro_bias_corrected_'), (1.0, 'gyro_error_compensated_'),
])  # fmt: skip
def test_an_inertial_sensor_may_have_other_axes_than_the_tracker(
    scale: float, gyro: str, tmp_path: Path
) -> None:
    f = lab_flight()
    down = np.array([1.0, -1.0, -1.0])
    sensed = three(gyro, scale * f['w'] * down) | three('acc_', f['a'] * down)
    source = write_csv(tmp_path / 'log.csv', timed(f) | place(f) | quaternion(f) | sensed)
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    import_draft(draft, source, tmp_path)
    imu = open_flight(read_bag(tmp_path / 'out' / 'bag'), None)['imu']
    np.testing.assert_allclose(stack_components(imu, 'angular_velocity'), f['w'], atol=1e-4)
    np.testing.assert_allclose(stack_components(imu, 'linear_acceleration'), f['a'], atol=1e-4)


def test_two_moving_bodies_are_asked_about_and_the_answer_selects_one(tmp_path: Path) -> None:
    f = lab_flight()
    other = f['p'][::-1] * [1.0, -1.0, 1.0]
    table = timed(f) | place(f, 'blue_') | quaternion(f, 'blue_q')
    table |= three('red_', other) | quaternion(f, 'red_q')
    source = write_csv(tmp_path / 'log.csv', table)
    (question,) = draft_mapping(source, {}).choices.questions
    assert (question.key, {name for name, _ in question.options}) == ('body', {'blue', 'red'})
    draft = draft_mapping(source, {'body': 'blue'})
    series = import_draft(draft, source, tmp_path)
    np.testing.assert_allclose(stack_components(series, 'pose.pose.position'), f['p'], atol=1e-3)


@pytest.mark.parametrize(('label', 'bodies', 'second'), [
    ('name', ('ship', 'rod'), 'still'), ('id', (4, 9), 'moving'),
])  # fmt: skip
def test_rows_of_several_bodies_that_follow_each_other(
    label: str, bodies: tuple[Any, Any], second: str, tmp_path: Path
) -> None:
    f = lab_flight()
    lines = [f't,{label},x,y,z,qx,qy,qz,qw']
    for k, time in enumerate(f['t']):
        other = [2.0, 1.0, 0.5] if second == 'still' else (-f['p'][-1 - k]).tolist()
        for body, spot in zip(bodies, (f['p'][k], other), strict=True):
            cells = [f'{one:.6f}' for one in (*spot, *f['q'][k])]
            lines.append(f'{time:.3f},{body},' + ','.join(cells))
    source = tmp_path / 'log.csv'
    source.write_text('\n'.join(lines) + '\n')
    asked = [one.key for one in draft_mapping(source, {}).choices.questions]
    assert asked == ([] if second == 'still' else ['body'])
    draft = draft_mapping(source, {'body': str(bodies[0])})
    series = import_draft(draft, source, tmp_path)
    np.testing.assert_allclose(stack_components(series, 'pose.pose.position'), f['p'], atol=1e-3)


def test_all_rows_of_a_body_may_follow_those_of_another(tmp_path: Path) -> None:
    f = lab_flight()
    lines = ['t,name,x,y,z,qx,qy,qz,qw']
    for body, spots in (('rod', np.ones_like(f['p'])), ('ship', f['p'])):
        rows = zip(f['t'], spots, f['q'], strict=True)
        lines += [','.join([f'{t:.3f}', body, *(f'{one:.6f}' for one in (*p, *q))])
                  for t, p, q in rows]  # fmt: skip
    source = tmp_path / 'log.csv'
    source.write_text('\n'.join(lines) + '\n')
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    series = import_draft(draft, source, tmp_path)
    np.testing.assert_allclose(stack_components(series, 'pose.pose.position'), f['p'], atol=1e-3)


@pytest.mark.parametrize('factor', [1.0, 1e7, np.pi / 180.0])
def test_a_fix_of_a_satellite_becomes_a_place_about_the_first(
    factor: float, tmp_path: Path
) -> None:
    """One degree is 111.2 km north, and 75.4 km east at 47.4 degrees."""
    f = lab_flight()
    fix = {
        'lat': np.round(factor * (47.4 + f['p'][:, 1] / 111_182.0), 11),
        'lon': np.round(factor * (8.5 + f['p'][:, 0] / 75_489.0), 11),
        'alt': (f['p'][:, 2] + 400.0) * (1e3 if factor > 1.0 else 1.0),
    }
    v = world_velocity(f)
    fix |= {'vn': v[:, 1], 've': v[:, 0], 'vd': -v[:, 2]}
    for name in ('lat', 'lon'):
        fix[name][1:4] = 0.0  # no fix
    source = tmp_path / 'log.csv'
    _, source = write_form(Form(lambda _: timed(f) | fix | quaternion(f)), source)
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    series = import_draft(draft, source, tmp_path)
    moved = f['p'] - f['p'][0]
    places = stack_components(series, 'pose.pose.position')
    assert np.isnan(places[1:4]).all()
    np.testing.assert_allclose(places[4:], moved[4:], atol=0.03)
    np.testing.assert_allclose(stack_components(series, 'twist.twist.linear'), f['v'], atol=0.01)


def test_a_question_about_the_floor_says_what_the_heights_are(tmp_path: Path) -> None:
    f = lab_flight()
    f['p'][:, 2] -= f['p'][:, 2].mean()
    source = write_csv(tmp_path / 'log.csv', timed(f) | place(f) | quaternion(f))
    (question,) = draft_mapping(source, {}).choices.questions
    low, high = np.percentile(f['p'][:, 2], [2.0, 98.0])
    assert f'z is {low:.3g} to {high:.3g} m' in question.reason


@pytest.mark.parametrize('shift', [50.0, 1500.0])
@pytest.mark.parametrize('name', ['height', 'altitude'])
def test_a_height_above_30_can_be_in_metres(name: str, shift: float, tmp_path: Path) -> None:
    f = lab_flight()
    table = timed(f) | place(f) | quaternion(f) | {name: f['p'][:, 2] + shift}
    (question,) = draft_mapping(write_csv(tmp_path / 'log.csv', table), {}).choices.questions
    assert question.key == 'range.range.unit'
    assert {'m', 'mm'} <= {unit for unit, _ in question.options}


def test_a_height_that_would_climb_too_fast_in_metres_is_in_mm(tmp_path: Path) -> None:
    f = lab_flight()
    height = 1200.0 + 500.0 * np.sin(0.2 * f['t'])
    noisy = 1200.0 + np.random.default_rng(2).normal(0.0, 3.0, len(f['t']))  # of a barometer in m
    for name, values, asked in (('height', height, False), ('altitude', noisy, True)):
        source = write_csv(tmp_path / f'{name}.csv', timed(f) | place(f) | {name: values})
        draft = draft_mapping(source, {})
        assert ('range.range.unit' in {one.key for one in draft.choices.questions}) is asked
        assert ('unit: mm' in draft.text) is not asked
        # The user knows better
        assert 'unit: mm' not in draft_mapping(source, {'range.range.unit': 'm'}).text


@pytest.mark.parametrize(('axes', 'drift', 'asked'), [
    ('ned', [0.5, 0.1, 0.0], False), ('xyz', [0.1, 0.5, 0.0], True),
])  # fmt: skip
def test_a_steady_velocity_across_a_turning_vehicle_is_no_motion_ahead(
    axes: str, drift: list[float], asked: bool, tmp_path: Path
) -> None:
    """Wind drives a vehicle that turns: names tell the frame, or the user does."""
    f = lab_flight()
    velocity = drift + 0.02 * f['v']
    source = write_csv(tmp_path / 'log.csv', timed(f) | quaternion(f)
                       | three('vel_', velocity, axes))  # fmt: skip
    draft = draft_mapping(source, {})
    keys = [one.key for one in draft.choices.questions]
    assert ('ground_truth/odom.velocity.frame' in keys) is asked
    assert ('frame: world' in draft.text) is not asked


def test_names_north_east_down_of_one_topic_say_nothing_of_another(tmp_path: Path) -> None:
    f = lab_flight()
    table = timed(f) | quaternion(f, 'vicon_q') | three('vicon_vel_', world_velocity(f), 'ned')
    table |= quaternion(f, 'est_q') | three('est_vel_', f['v'] + [0.5, 0.0, 0.0])
    source = write_csv(tmp_path / 'log.csv', table)
    entries = yaml.safe_load(draft_mapping(source, {}).text)['topics']
    frames = {entry['topic']: entry['velocity'].get('frame', 'body') for entry in entries}
    assert frames == {'ground_truth/odom': 'world', 'odom': 'body'}


def test_a_heading_alone_says_nothing_of_the_vertical(tmp_path: Path) -> None:
    """The places are those of a game engine: x right, y up, z ahead."""
    f = lab_flight()
    table = timed(f, yaw=compass(f)) | three('pos_', f['p'][:, [0, 2, 1]] * [1, 1, 3] + [0, 0, 9])
    questions = draft_mapping(write_csv(tmp_path / 'log.csv', table), {}).choices.questions
    (up,) = (one for one in questions if one.key == 'world.up')
    assert [name for name, _ in up.options] == ['up', 'down', 'y']


def test_jumps_of_a_tracker_do_not_decide_on_the_unit(tmp_path: Path) -> None:
    f = lab_flight()
    f['p'][::7] += [1.2, -0.7, 0.4]
    draft = draft_mapping(write_csv(tmp_path / 'log.csv', timed(f) | place(f) | quaternion(f)), {})
    assert draft.choices.questions == []
    assert 'position: {columns: [x, y, z], unit: m}' in draft.text
    assert 'doubtful' in [one.reading for one in draft.choices.reasons]


def test_a_heading_over_a_world_with_z_down_is_that_of_an_upright_vehicle(tmp_path: Path) -> None:
    f = lab_flight()
    table = timed(f, yaw=-f['rpy'][:, 2]) | three('', f['p'] * DOWN)
    source = write_csv(tmp_path / 'log.csv', table)
    series = import_draft(draft_mapping(source, {}), source, tmp_path)
    np.testing.assert_allclose(stack_components(series, 'pose.pose.position'), f['p'], atol=1e-6)
    attitude = Rotation.from_quat(stack_components(series, 'pose.pose.orientation'))
    level = Rotation.from_euler('Z', f['rpy'][:, 2:])
    assert np.degrees((attitude.inv() * level).magnitude()).max() < 0.01


def test_an_autopilots_fix_has_its_velocity_north_east_down_and_a_heading_in_no_unit(
    tmp_path: Path,
) -> None:
    """As MAVLink's GLOBAL_POSITION_INT: 1e-7 degrees, mm, cm/s and 0.01 degrees."""
    f = lab_flight()
    table = {
        'time_boot_ms': 1e3 * f['t'], 'lat': 1e7 * (47.4 + f['p'][:, 1] / 111_182.0),
        'lon': 1e7 * (8.5 + f['p'][:, 0] / 75_489.0), 'alt': 1e3 * f['p'][:, 2] + 4e5,
        'hdg': 100.0 * compass(f),
    }  # fmt: skip
    table |= three('v', 100.0 * world_velocity(f) @ TO_NED.T)
    draft = draft_mapping(write_form(Form(lambda _: table), tmp_path / 'log.csv')[1], {})
    rows = {one.part: one for one in draft.choices.reasons}
    assert draft.choices.questions == []
    # Without an attitude, a velocity in world axes is left out; here it is not asked about
    assert rows['ground_truth/odom: velocity'].columns == 'vy, vx, vz'
    assert rows['ground_truth/odom: orientation'].reading == 'left out'


def test_places_of_two_bodies_in_turn_are_called_doubtful(tmp_path: Path) -> None:
    f = lab_flight()
    f['p'][1::2] = [2.0, 2.0, 0.3]
    source = write_csv(tmp_path / 'log.csv', timed(f) | place(f) | quaternion(f))
    rows = {one.reading: one.reason for one in draft_mapping(source, {}).choices.reasons}
    assert rows['doubtful'].startswith(f'{len(f["t"]) - 1} of {len(f["t"])} rows jump')
