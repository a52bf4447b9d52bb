# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Files of arrays, written by the libraries themselves: MATLAB, NumPy, Parquet, and folders."""

import pickle

from lta_config.errors import BadInput
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from scipy.io import savemat

from .csv_texts import ODOM

IMU = '/lta1/imu'
HEAD = 'schema: 1\nname: mine\nabout: a test\n'
POSE = (
    'time: {column: t, unit: ms}\n'
    'topics:\n'
    '  - topic: ground_truth/odom\n'
    '    position: {columns: ["p[0]", "p[1]", "p[2]"], unit: mm}\n'
)
TIME = np.array([5000, 5010, 5020], dtype=np.int64)  # ms
PLACE = np.array([[1000.0, 2000.0, 3000.0], [1001.0, 2002.0, 3003.0], [4.0, 5.0, 6.0]])
STAMPS = [5_000_000_000, 5_010_000_000, 5_020_000_000]


def expect_places(got):
    places = [m.pose.pose.position for m in got.messages[ODOM]]
    # Multiplication by 0.001 may round the last digit
    assert [number for p in places for number in (p.x, p.y, p.z)] == pytest.approx(
        [1.0, 2.0, 3.0, 1.001, 2.002, 3.003, 0.004, 0.005, 0.006], rel=1e-15
    )
    assert got.stamps(ODOM) == STAMPS


def test_a_matlab_file_of_vectors_and_a_matrix(bring, tmp_path):
    source = tmp_path / 'run.mat'
    savemat(source, {'t': TIME, 'p': PLACE, 'who': 'me', 'mass': 0.4})
    got = bring(source, HEAD + 'format: mat\n' + POSE)
    expect_places(got)
    assert 'left out: who, mass' in got.notes


def test_structs_of_a_matlab_file_are_tables_with_times_of_their_own(bring, tmp_path):
    source = tmp_path / 'run.mat'
    imu = {'t': np.arange(4) * 0.5 + 5.0, 'gyro': np.arange(12.0).reshape(4, 3)}
    savemat(source, {'vicon': {'t': TIME, 'p': PLACE}, 'imu': imu})
    mapping = (
        'format: mat\n' + POSE.replace('    position', '    table: vicon\n    position')
        + '  - topic: imu\n    table: imu\n    time: {column: t, unit: s}\n'
        '    rates: {columns: ["gyro[0]", "gyro[1]", "gyro[2]"], unit: deg/s}\n'
    )  # fmt: skip
    got = bring(source, HEAD + mapping)
    expect_places(got)
    assert got.stamps(IMU) == [5_000_000_000, 5_500_000_000, 6_000_000_000, 6_500_000_000]
    assert got.messages[IMU][3].angular_velocity.z == pytest.approx(np.radians(11.0))
    # Merged by time
    assert got.order == [ODOM, IMU, ODOM, ODOM, IMU, IMU, IMU]


def test_a_matlab_file_of_version_7_3_is_refused_with_the_remedy(bring, tmp_path):
    source = tmp_path / 'run.mat'
    head = b'MATLAB 7.3 MAT-file, Platform: GLNXA64'.ljust(512, b'\0')
    source.write_bytes(head + b'\x89HDF\r\n\x1a\n' + bytes(100))
    with pytest.raises(BadInput, match=r"version 7\.3 .* save it with save\(FILE, '-v7'\)"):
        bring(source, HEAD + 'format: mat\n' + POSE)


def test_an_archive_of_arrays(bring, tmp_path):
    source = tmp_path / 'run.npz'
    np.savez_compressed(source, t=TIME, p=PLACE)
    expect_places(bring(source, HEAD + 'format: numpy\n' + POSE))


def test_one_array_has_numbered_columns(bring, tmp_path):
    source = tmp_path / 'run.npy'
    # Time runs along the longer side
    np.save(source, np.column_stack([TIME.astype(float), PLACE])[[0, 1, 2, 2, 2]].T)
    mapping = POSE.replace('"p[0]", "p[1]", "p[2]"', 'column_2, column_3, column_4')
    got = bring(source, HEAD + 'format: numpy\n' + mapping.replace(': t,', ': column_1,'))
    assert got.stamps(ODOM) == [*STAMPS, STAMPS[2], STAMPS[2]]
    assert got.messages[ODOM][2].pose.pose.position.z == 0.006


def test_a_parquet_table(bring, tmp_path):
    source = tmp_path / 'run.parquet'
    columns = {'t': TIME} | {f'p[{i}]': PLACE[:, i] for i in range(3)}
    pq.write_table(pa.table(columns | {'word': ['a', 'b', 'c']}), source)
    got = bring(source, HEAD + 'format: parquet\n' + POSE)
    expect_places(got)
    assert 'left out: word' in got.notes


def test_a_folder_with_a_file_for_each_sensor(bring, tmp_path):
    folder = tmp_path / 'flight'
    (folder / 'imu0').mkdir(parents=True)
    np.savez(folder / 'vicon.npz', t=TIME, p=PLACE)
    text = '# t [s]; wx; wy; wz\n5.0; 1; 2; 3\n5.5; 4; 5; 6\n6; 7'
    (folder / 'imu0' / 'data.csv').write_text(text)
    mapping = (
        'format: folder\n' + POSE.replace('    position', '    table: vicon\n    position')
        + '  - topic: imu\n    table: imu0\n    time: {column: "t [s]", unit: s}\n'
        '    rates: {columns: [wx, wy, wz], unit: rad/s}\n'
    )  # fmt: skip
    got = bring(folder, HEAD + mapping)
    expect_places(got)
    assert got.stamps(IMU) == [5_000_000_000, 5_500_000_000]
    assert [m.angular_velocity.y for m in got.messages[IMU]] == [2.0, 5.0]
    assert 'imu0: The last line is cut off and skipped.' in got.notes


class Command:
    """A class whose unpickling would write a file."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (open, (str(self.path), 'w'))


def test_an_array_of_too_many_fields_is_no_pickle(bring, tmp_path):
    source = tmp_path / 'fields.npy'
    np.save(source, np.zeros(3, [(f'f{k}', 'f8') for k in range(2000)]))
    with pytest.raises(BadInput, match=r'cannot be read as a NumPy file .*Header info length'):
        bring(source, HEAD + 'format: numpy\n' + POSE)


@pytest.mark.parametrize('kind', ['pickle', 'npy', 'npz'])
def test_pickles_are_refused_and_not_run(bring, tmp_path, kind):
    trap = tmp_path / 'ran'
    source = tmp_path / f'run.{kind}'
    if kind == 'pickle':
        source.write_bytes(pickle.dumps(Command(trap)))
    elif kind == 'npy':
        np.save(source, np.array([Command(trap)], dtype=object))
    else:
        np.savez(source, t=TIME, p=np.array([Command(trap)], dtype=object))
    with pytest.raises(BadInput, match='does not unpickle files, since a pickle can run'):
        bring(source, HEAD + 'format: numpy\n' + POSE if kind != 'pickle' else None)
    assert not trap.exists()


@pytest.mark.parametrize('kind', ['mat', 'npz', 'npy', 'parquet'])
def test_a_damaged_file_is_one_sentence(bring, tmp_path, kind):
    source = tmp_path / f'run.{kind}'
    if kind == 'mat':
        savemat(source, {'t': TIME, 'p': PLACE})
    elif kind == 'parquet':
        pq.write_table(pa.table({'t': TIME}), source)
    elif kind == 'npz':
        np.savez(source, t=TIME, p=PLACE)
    else:
        np.save(source, PLACE)
    source.write_bytes(source.read_bytes()[:-30])
    form = {'npz': 'numpy', 'npy': 'numpy'}.get(kind, kind)
    with pytest.raises(BadInput, match='copy it again') as told:
        bring(source, HEAD + f'format: {form}\n' + POSE, format=form)
    assert '\n' not in str(told.value)


FORCES = (
    'time: {rate: 10 Hz}\nbody: FRD\n'
    'topics:\n'
    '  - topic: wrench_command\n'
    '    forces:\n'
    '      - {columns: ["f[0]", "f[1]", "f[2]"], unit: mN, at: {value: [10, 0, 0], unit: cm}}\n'
    '      - {value: {value: [2, 0, 0], unit: N}, at: {value: [0, 0.5, 0], unit: m}}\n'
)


def test_forces_at_points_become_force_and_torque(bring, tmp_path):
    source = tmp_path / 'run.npz'
    np.savez(source, f=np.array([[0.0, 0.0, 1000.0], [0.0, 3000.0, 0.0]]).T.repeat(2, axis=1).T)
    got = bring(source, HEAD + 'format: numpy\n' + FORCES)
    one, *_, last = (m.wrench for m in got.messages['/lta1/wrench_command'])
    # FRD: 1 N down at 0.1 m forward; r x F = (0.1, 0, 0) x (0, 0, 1) = (0, -0.1, 0) in FRD
    # and 2 N forward at 0.5 m right: (0, 0.5, 0) x (2, 0, 0) = (0, 0, -1); FLU negates y and z
    assert (one.force.x, one.force.y, one.force.z) == pytest.approx((2.0, 0.0, -1.0))
    assert (one.torque.x, one.torque.y, one.torque.z) == pytest.approx((0.0, 0.1, 1.0))
    # 3 N right at 0.1 m forward: (0.1, 0, 0) x (0, 3, 0) = (0, 0, 0.3) in FRD
    assert (last.force.x, last.force.y, last.force.z) == pytest.approx((2.0, -3.0, 0.0))
    assert (last.torque.x, last.torque.y, last.torque.z) == pytest.approx((0.0, 0.0, 0.7))


ROTORS = (
    'time: {rate: 10 Hz}\n'
    'topics:\n'
    '  - topic: motors\n'
    '    actuators:\n'
    '      left: {velocity: {column: left, unit: rpm}, thrust: [0.01, 0.0, 1.0e-6]}\n'
    '      right: {velocity: {column: right, unit: rad/s}}\n'
)


def test_rotor_speeds_become_thrust_by_a_law(bring, tmp_path):
    source = tmp_path / 'run.npz'
    np.savez(source, left=np.array([3000.0, -3000.0]), right=np.array([10.0, 20.0]))
    got = bring(source, HEAD + 'format: numpy\n' + ROTORS)
    first, second = got.messages['/lta1/motors']
    # 3000 rpm = 100 pi rad/s; 1e-6 (100 pi)^2 = 0.098696
    assert first.velocity == pytest.approx([100.0 * np.pi, 10.0])
    assert first.effort[0] == pytest.approx(0.01 + 0.098696044)
    assert second.effort[0] == pytest.approx(0.01 - 0.098696044)
    assert np.isnan(first.effort[1])


def test_a_law_without_a_speed_is_refused(bring, tmp_path):
    source = tmp_path / 'run.npz'
    np.savez(source, left=np.arange(3.0), right=np.arange(3.0))
    wrong = ROTORS.replace('velocity: {column: left, unit: rpm}', 'effort: {column: left}')
    with pytest.raises(BadInput, match='has "thrust", which derives the effort'):
        bring(source, HEAD + 'format: numpy\n' + wrong)
