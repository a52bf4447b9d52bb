# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the motion contradicts is never read as its name says without a question."""

from collections.abc import Callable
from pathlib import Path

from lta_bag.reader import read_bag
from lta_data.bag.recorded_flight import open_flight
from lta_data.bag.table import stack_components
from lta_data.importers.draft.draft_mapping import draft_mapping
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .lab_flights import DOWN, lab_flight, three, write_csv
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
    turned,
    world_velocity,
)

Y_UP = Rotation.from_euler('x', -90.0, degrees=True)  # of the world: its y is our z


def y_up(f: Flight, body: Rotation) -> dict[str, Array]:
    """Return a pose with y up, of a body with its axes turned."""
    q = (Y_UP * turned(f) * body.inv()).as_quat()
    pose: dict[str, Array] = {f'q{axis}': q[:, k] for k, axis in enumerate('xyzw')}
    return timed(f) | three('', Y_UP.apply(f['p'])) | pose


# Read against the names or the usual axes, as the motion says
READ: dict[str, Callable[[Flight], dict[str, Array]]] = {
    'roll inverted': lambda f: timed(f) | place(f) | angles(f, signs=(-1, 1, 1))
    | three('gyro_', f['w']),
    'degrees called radians': lambda f: timed(f) | place(f)
    | angles(f, 'roll_rad pitch_rad yaw_rad') | three('gyro_', f['w']),
    'radians called degrees': lambda f: timed(f) | place(f)
    | angles(f, 'roll_deg pitch_deg yaw_deg', scale=1.0) | three('gyro_', f['w']),
    'x, y, z, w below the names w, x, y, z': lambda f: timed(f) | place(f)
    | dict(zip(('qw', 'qx', 'qy', 'qz'), f['q'].T, strict=True)) | three('gyro_', f['w']),
    'y up of the world alone': lambda f: y_up(f, Rotation.identity()) | three('gyro_', f['w'])
    | three('acc_', f['a']),
    'y up of the tracker, and not of the sensor': lambda f: y_up(f, Y_UP)
    | three('gyro_', f['w']) | three('acc_', f['a']),
    'a sensor that is turned by 90 degrees': lambda f: timed(f) | place(f) | quaternion(f)
    | three('gyro_', f['w'][:, [1, 0, 2]] * [1, -1, 1])
    | three('acc_', f['a'][:, [1, 0, 2]] * [1, -1, 1]),
    'the elements of a matrix': lambda f: timed(f) | place(f) | {
        f'R{i + 1}{j + 1}': turned(f).as_matrix()[:, i, j] for i in range(3) for j in range(3)
    },
    'a rotation vector': lambda f: timed(f) | place(f) | three('rotvec_', turned(f).as_rotvec()),
}  # fmt: skip


@pytest.mark.parametrize('write', READ.values(), ids=READ)
def test_the_motion_decides_against_a_name(
    write: Callable[[Flight], dict[str, Array]], tmp_path: Path
) -> None:
    f = lab_flight()
    source = write_csv(tmp_path / 'log.csv', write(f))
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    series = import_draft(draft, source, tmp_path)
    np.testing.assert_allclose(stack_components(series, 'pose.pose.position'), f['p'], atol=1e-6)
    attitude = Rotation.from_quat(stack_components(series, 'pose.pose.orientation'))
    assert np.degrees((attitude.inv() * turned(f)).magnitude()).max() < 0.01
    if 'topic: imu' in draft.text:
        imu = open_flight(read_bag(tmp_path / 'out' / 'bag'), None)['imu']
        np.testing.assert_allclose(stack_components(imu, 'angular_velocity'), f['w'], atol=1e-6)


ASKED: dict[str, tuple[Callable[[Flight], dict[str, Array]], str, str]] = {
    'rates in degrees called radians': (
        lambda f: timed(f) | place(f) | quaternion(f)
        | {f'gyro_{a}_rad_s': DEGREES * f['w'][:, k] for k, a in enumerate('xyz')},
        'imu.rates.unit', 'deg/s',
    ),
    'metres called millimetres': (
        lambda f: timed(f) | {f'{a}_mm': f['p'][:, k] for k, a in enumerate('xyz')}
        | quaternion(f) | three('v', world_velocity(f)),
        'ground_truth/odom.position.unit', 'm',
    ),
    'millimetres called metres': (
        lambda f: timed(f) | {f'{a}_m': 1e3 * f['p'][:, k] for k, a in enumerate('xyz')}
        | quaternion(f),
        'ground_truth/odom.position.unit', 'mm',
    ),
    'milliseconds called seconds': (
        lambda f: {'time_s': 1e3 * f['t']} | place(f) | quaternion(f), 'time.unit', 'ms',
    ),
    'a place with y mirrored': (
        lambda f: timed(f) | three('', f['p'] * [1, -1, 1]) | quaternion(f)
        | three('gyro_', f['w']),
        'ground_truth/odom.position.axes', 'mirrored',
    ),
    'an attitude north, east, down beside a place in our axes': (
        lambda f: timed(f) | place(f) | dict(zip(('qx', 'qy', 'qz', 'qw'), in_ned(f).T,
                                                 strict=True)) | three('gyro_', f['w'] * DOWN),
        'ground_truth/odom.position.axes', 'world',
    ),
    'a velocity with x and y exchanged': (
        lambda f: timed(f) | place(f) | quaternion(f) | three('v', f['v'][:, [1, 0, 2]]),
        'ground_truth/odom.velocity.frame', 'none',
    ),
    'an accelerometer that counts gravity down': (
        lambda f: timed(f) | place(f) | quaternion(f) | three('acc_', -f['a']),
        'world.up', 'up',
    ),
    'a place alone, above a floor along y': (
        lambda f: timed(f) | three('', Y_UP.apply(f['p'])), 'world.up', 'y',
    ),
}  # fmt: skip


@pytest.mark.parametrize(('write', 'key', 'answer'), ASKED.values(), ids=ASKED)
def test_a_contradiction_is_asked_and_the_answer_reads_it(
    write: Callable[[Flight], dict[str, Array]], key: str, answer: str, tmp_path: Path
) -> None:
    f = lab_flight()
    source = write_csv(tmp_path / 'log.csv', write(f))
    (question,) = draft_mapping(source, {}).choices.questions
    assert question.key == key
    assert answer in [name for name, _ in question.options]
    draft = draft_mapping(source, {key: answer})
    assert draft.choices.questions == []
    series = import_draft(draft, source, tmp_path)
    np.testing.assert_allclose(np.ptp(series.index), np.ptp(f['t']), atol=1e-3)
    np.testing.assert_allclose(stack_components(series, 'pose.pose.position'), f['p'], atol=1e-5)
