# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Commands and poses that two computers recorded are brought onto one clock by the motion."""

import json

from lta_config.errors import BadInput
from lta_data.importers.draft.draft_mapping import draft_mapping
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
import yaml

from .csv_texts import ODOM
from .lab_flights import three


def write_run(folder, seed, began, pressed):
    """Write poses and commands of a random flight, each on its own clock."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 60.0, 0.02)
    # Force and moment change every two seconds; both speeds follow, and decay
    told = rng.uniform(-1.0, 1.0, (30, 2)).repeat(100, axis=0) * [0.2, 0.1]
    speed = np.zeros((len(t), 2))
    for k in range(1, len(t)):
        speed[k] = speed[k - 1] + 0.02 * (told[k - 1] - 0.3 * speed[k - 1])
    yaw = 0.02 * np.cumsum(speed[:, 1])
    place = np.cumsum(speed[:, :1] * np.column_stack([np.cos(yaw), np.sin(yaw)]), axis=0) * 0.02
    place = np.column_stack([place, 0.0 * t + 1.0]) + rng.normal(0.0, 5e-4, (len(t), 3))
    turn = Rotation.from_rotvec(np.outer(yaw, [0.0, 0.0, 1.0])).as_quat()
    folder.mkdir(parents=True)
    poses = {'time': began + t, **three('p', place), **three('q', turn, 'xyzw')}
    rows = np.column_stack(list(poses.values()))
    np.savetxt(folder / 'mocap.csv', rows, '%.6f', ',', header=','.join(poses), comments='')
    # The commands were recorded from the tenth second on, at 10 Hz
    rows = np.column_stack([t - 10.0 + pressed, told])[500::5]
    np.savetxt(folder / 'stick.csv', rows, '%.6f', ',', header='t,fx,tz', comments='')


@pytest.mark.parametrize(('name', 'began'), [('a', 1.7e9), ('b', 1.7e9 + 900.0)])
def test_commands_on_a_clock_of_their_own_are_moved_to_the_motion(bring, tmp_path, name, began):
    write_run(tmp_path / 'runs' / 'a', 1, 1.7e9, 3.2)
    write_run(tmp_path / 'runs' / 'b', 2, 1.7e9 + 900.0, 40.0)
    draft = draft_mapping(tmp_path / 'runs', {})
    assert 'The 2 folders of runs are runs with the same tables.' in draft.source.notes
    got = bring(tmp_path / 'runs' / name, draft.text)
    assert got.stamps(ODOM)[0] == round(began * 1e9)
    assert got.stamps('/lta1/wrench_command')[0] * 1e-9 == pytest.approx(began + 10.0, abs=0.25)
    assert 'are added to the times of stick: there, the commands explain' in got.notes


def write_step(folder, seed):
    """Write a step of 8 s in a log of 14 s, in gusty air, with two clocks that begin together."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 14.0, 0.02)
    told = np.where((t > 2.0) & (t < 10.0), -0.1, 0.0)
    gust = np.repeat(rng.normal(0.0, 0.05, (14, 3)), 50, axis=0)
    speed = np.zeros((len(t), 3))
    for k in range(1, len(t)):
        push = gust[k - 1] + [told[k - 1], 0.0, 0.0]
        speed[k] = speed[k - 1] + 0.02 * (push - 0.3 * speed[k - 1])
    yaw = 0.02 * np.cumsum(speed[:, 1])
    along = np.column_stack([speed[:, 0] * np.cos(yaw), speed[:, 0] * np.sin(yaw), speed[:, 2]])
    place = np.cumsum(along, axis=0) * 0.02 + rng.normal(0.0, 5e-4, (len(t), 3))
    turn = Rotation.from_rotvec(np.outer(yaw, [0.0, 0.0, 1.0])).as_quat()
    folder.mkdir(parents=True)
    poses = {'time': 1.7e9 + t, **three('p', place), **three('q', turn, 'xyzw')}
    rows = np.column_stack(list(poses.values()))
    np.savetxt(folder / 'mocap.csv', rows, '%.6f', ',', header=','.join(poses), comments='')
    rows = np.column_stack([t, told, 0.0 * t])[::3]
    np.savetxt(folder / 'stick.csv', rows, '%.6f', ',', header='t,fx,tz', comments='')


@pytest.mark.parametrize('seed', [2, 10, 11, 14])
def test_the_end_of_a_step_explains_no_other_acceleration(tmp_path, seed):
    """
    A wrong offset of several seconds leaves half of the log without commands.

    There, the one edge of a step can coincide with a gust.
    """
    write_step(tmp_path / 'a', seed)
    draft = draft_mapping(tmp_path / 'a', {})
    times = [one.reading for one in draft.choices.reasons if 'later' in one.reading]
    (later,) = [float(one.split()[0]) for one in times]
    assert later == pytest.approx(1.7e9, abs=0.5)


def test_commands_that_move_nothing_are_taken_to_begin_with_the_pose(tmp_path):
    write_run(tmp_path / 'a', 1, 1.7e9, 3.2)
    stick = tmp_path / 'a' / 'stick.csv'
    head, *rows = stick.read_text().splitlines()
    rng = np.random.default_rng(0)
    noise = [f'{row.split(",")[0]},{x:.3f},{y:.3f}' for row, (x, y) in
             zip(rows, rng.normal(size=(len(rows), 2)), strict=True)]  # fmt: skip
    stick.write_text('\n'.join([head, *noise]) + '\n')
    draft = draft_mapping(tmp_path / 'a', {})
    (reason,) = [
        one for one in draft.choices.reasons if one.part == 'stick.time' and 'later' in one.reading
    ]
    assert reason.reading == f'{1.7e9 - 3.2:.2f} s later'
    assert reason.reason == 'another clock than mocap; taken to begin together: check it'
    given = draft_mapping(tmp_path / 'a', {'stick.time.start': '1700000007 s'})
    times = {one['table']: one['time'] for one in yaml.safe_load(given.text)['topics']}
    assert times['stick'] == {'column': 't', 'unit': 's', 'start': '1700000007.000 s'}


def test_an_offset_is_given_as_a_time(tmp_path):
    write_run(tmp_path / 'a', 1, 1.7e9, 3.2)
    for given in ('7', 'soon', '7 m'):
        with pytest.raises(BadInput, match="must be a time, such as '3"):
            draft_mapping(tmp_path / 'a', {'stick.time.start': given})
    given = draft_mapping(tmp_path / 'a', {'stick.time.start': '500 ms'})
    assert 'start: 0.500 s' in given.text


def test_the_table_that_align_names_decides(bring, tmp_path):
    """An estimate on a clock of its own stands first in the folder; the tracker is named."""
    write_run(tmp_path / 'a', 1, 1.7e9, 3.2)
    draft = draft_mapping(tmp_path / 'a', {}).text
    text = (tmp_path / 'a' / 'mocap.csv').read_text()
    (tmp_path / 'a' / 'ekf.csv').write_text(text.replace('17000000', '17000900'))
    truth = draft[draft.index('  - topic: ground_truth/odom') :]
    estimate = truth.replace('ground_truth/odom', 'odom').replace('mocap', 'ekf')
    got = bring(tmp_path / 'a', draft.replace('topics:\n', f'topics:\n{estimate.rstrip()}\n'))
    first = got.stamps('/lta1/wrench_command')[0] * 1e-9
    assert first == pytest.approx(1.7e9 + 10.0, abs=0.25)


def test_a_table_without_a_pose_aligns_nothing(bring, tmp_path):
    write_run(tmp_path / 'a', 1, 1.7e9, 3.2)
    draft = draft_mapping(tmp_path / 'a', {}).text
    with pytest.raises(BadInput, match="'mocup', which has no position and attitude"):
        bring(tmp_path / 'a', draft.replace('align: mocap', 'align: mocup'))


def test_tables_that_overlap_a_little_are_on_one_clock(tmp_path):
    """Commands from 45 s after the poses began, to 40 s after these ended."""
    write_run(tmp_path / 'a', 1, 100.0, 145.0)
    mapping = draft_mapping(tmp_path / 'a', {'stick.time.start': '0 s'}).text
    assert 'align' not in mapping
    assert 'align' not in draft_mapping(tmp_path / 'a', {}).text


@pytest.mark.parametrize('times', ['nan', '0', 'same'])
def test_odd_times_of_commands_end_no_draft(tmp_path, times):
    write_run(tmp_path / 'a', 1, 1.7e9, 3.2)
    stick = tmp_path / 'a' / 'stick.csv'
    head, *rows = stick.read_text().splitlines()
    parts = [row.partition(',') for row in rows]
    if times == 'nan':
        rows[-1] = f'nan,{parts[-1][2]}'
    elif times == '0':
        rows = [
            f'0,{parts[0][2]}',
            *(f'{1.7e9 + float(t):.3f},{rest}' for t, _, rest in parts[1:]),
        ]
    else:
        rows = [f'5,{rest}' for _, _, rest in parts]
    stick.write_text('\n'.join([head, *rows]) + '\n')
    assert 'wrench_command' in draft_mapping(tmp_path / 'a', {}).text


def test_commands_stamped_seconds_early_on_a_common_clock_are_asked_about(tmp_path):
    write_run(tmp_path / 'a', 1, 100.0, 103.0)
    (question,) = draft_mapping(tmp_path / 'a', {}).choices.questions
    assert question.key == 'stick.time.start'
    stay, move = (float(option.split()[0]) for option, _ in question.options)
    assert stay == 0.0
    assert move == pytest.approx(7.0, abs=0.25)


def test_a_sensor_on_the_clock_of_the_commands_moves_with_them(bring, tmp_path):
    write_run(tmp_path / 'a', 1, 1.7e9, 3.2)
    t = np.arange(3.2, 50.0, 0.1)
    rows = np.column_stack([t, *(0.01 * t for _ in range(3)), *(9.8 + 0.0 * t for _ in range(3))])
    head = 't,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z'
    np.savetxt(tmp_path / 'a' / 'imu.csv', rows, '%.6f', ',', header=head, comments='')
    draft = draft_mapping(tmp_path / 'a', {})
    assert 'the clock of stick' in {reason.reason for reason in draft.choices.reasons}
    got = bring(tmp_path / 'a', draft.text)
    begun = [got.stamps(f'/lta1/{name}')[0] * 1e-9 for name in ('wrench_command', 'imu')]
    assert begun == pytest.approx([1.7e9 + 10.0] * 2, abs=0.25)
    assert 'added to the times of imu: the clock of stick.' in got.notes


@pytest.mark.parametrize('anew', [0.0, 40.0])
def test_logs_of_two_computers_that_stay_on_share_one_offset(call, tmp_path, anew):
    """The stick's clock counts on for all runs, or begins anew with the second."""
    runs = tmp_path / 'runs'
    for name, later in (('a', 0.0), ('b', 600.0), ('c', 1200.0)):
        pressed = 3.2 + later + (anew if name == 'b' else 0.0)
        write_run(runs / name, 1 + len(name) + int(later), 1.7e9 + later, pressed)
    # Nobody could tell from the last one
    stick = runs / 'c' / 'stick.csv'
    head, *rows = stick.read_text().splitlines()
    stick.write_text('\n'.join([head, *(f'{row.split(",")[0]},0,0' for row in rows)]) + '\n')
    (tmp_path / 'm.yaml').write_text(draft_mapping(runs, {}).text)
    status, told = call('import', runs, '--mapping', tmp_path / 'm.yaml', '--out',
                        tmp_path / 'out', '--json')  # fmt: skip
    assert status == 0
    notes = [' '.join(one['notes']) for one in json.loads(told.out)]
    if anew:
        assert sum('The logs do not agree on it' in note for note in notes) == 2
        return
    offsets = [note[: note.index(' s are added')].split()[-1] for note in notes]
    assert len({*offsets}) == 1
    assert float(offsets[0]) == pytest.approx(1.7e9 + 10.0 - 3.2, abs=0.25)
    assert all('that of 2 logs, which agree within' in note for note in notes)
