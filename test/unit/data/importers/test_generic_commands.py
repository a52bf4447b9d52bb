# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Commands with names that labs use: by name, by the motion, or asked for."""

import itertools

from lta_data.importers.draft.draft_mapping import draft_mapping
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
import yaml

from .lab_flights import three, write_csv
from .test_wrench_axes import fly_commands, STEP


def write_motion(path, place, turn, commands):
    """Write poses with the noise of a tracker, and commands by the names of their columns."""
    noise = np.random.default_rng(2).normal(0.0, 3e-4, place.shape)
    return write_csv(path, {
        't': 9.0 + STEP * np.arange(len(place)), **three('p', place + noise),
        **three('q', turn.as_quat(), 'xyzw'), **commands,
    })  # fmt: skip


def draft_commands(path, names, responds=True, order=(0, 1, 2)):
    """Draft a flight whose commands for surge, heave and yaw have these names, in an order."""
    orders, place, turn = fly_commands(responds)
    orders = orders / np.abs(orders).max(axis=0)
    commands = dict(zip(names.split(), orders[:, order].T, strict=True))
    draft = draft_mapping(write_motion(path, place, turn, commands), {})
    return draft, {one['topic']: one for one in yaml.safe_load(draft.text)['topics']}


def list_asked(draft):
    return [one.key for one in draft.choices.questions if one.key.endswith('.command')]


@pytest.mark.parametrize('names', [
    'T_x T_z M_z', 'Tx Tz Mz', 'ux uz upsi', 'Ux Uz Uyaw', 'u_x u_z u_psi', 'u1 u2 u3',
    'tau1 tau2 tau3', 'tau_1 tau_2 tau_3', 'cmd1 cmd2 cmd3', 'control_0 control_1 control_2',
    'f_fwd f_up t_yaw', 'tau_u tau_w tau_r', 'tau_X tau_Z tau_N', 'X_cmd Z_cmd N_cmd',
    'thrust_cmd lift_cmd yaw_cmd', 'u_thrust u_lift u_turn', 'joy_x joy_z joy_yaw',
    'cmd_thrust cmd_z cmd_yaw', 'u_v u_h u_psi', 'F_surge F_heave M_yaw', 'fx_cmd fz_cmd mz_cmd',
    'forward_thrust vertical_thrust yaw_torque', 'ch1 ch2 ch3', 'F1 F2 F3', 'a1 a2 a3',
    'throttle elevator rudder', 'action_0 action_1 action_2', 'throttle cmd_lift steering',
])  # fmt: skip
def test_forces_ahead_and_up_and_the_moment_about_z(tmp_path, names):
    draft, topics = draft_commands(tmp_path / 'a.csv', names)
    ahead, up, left = names.split()
    assert list_asked(draft) == []
    assert {*topics} == {'ground_truth/odom', 'wrench_command'}
    assert topics['wrench_command']['force']['columns'] == [ahead, None, up]
    assert topics['wrench_command']['torque']['columns'] == [None, None, left]


@pytest.mark.parametrize('order', [*itertools.permutations(range(3))])
def test_numbers_drive_what_follows_them(tmp_path, order):
    draft, topics = draft_commands(tmp_path / 'a.csv', 'tau1 tau2 tau3', order=order)
    assert list_asked(draft) == []
    column = {of: f'tau{k + 1}' for k, of in enumerate(order)}
    assert topics['wrench_command']['force']['columns'] == [column[0], None, column[1]]
    assert topics['wrench_command']['torque']['columns'] == [None, None, column[2]]
    reasons = {one.columns: one.reason for one in draft.choices.reasons if one.part == 'commands'}
    assert 'of the yaw acceleration' in reasons[column[2]]


@pytest.mark.parametrize('names', ['tau1 tau2 tau3', 'u_1 u_2 u_3', 'cmd_1 cmd_2 cmd_3',
                                   'T1 T2 T3', 'joy_x joy_z joy_yaw', 'a1 a2 a3',
                                   'throttle elevator rudder'])  # fmt: skip
def test_numbers_that_nothing_follows_are_asked(tmp_path, names):
    draft, topics = draft_commands(tmp_path / 'a.csv', names, responds=False)
    assert list_asked(draft) == [f'{name}.command' for name in names.split()]
    assert {*topics} == {'ground_truth/odom'}


def test_a_servo_is_asked_whatever_follows_it(tmp_path):
    draft, topics = draft_commands(tmp_path / 'a.csv', 'throttle servo rudder')
    assert list_asked(draft) == ['servo.command']
    assert topics['wrench_command']['torque']['columns'] == [None, None, 'rudder']


def test_three_numbers_of_the_length_of_gravity_are_an_accelerometer(tmp_path):
    orders, place, turn = fly_commands()
    felt = turn.inv().apply([0.0, 0.0, 9.81]) + 0.3 * orders / np.abs(orders).max(axis=0)
    path = write_motion(tmp_path / 'a.csv', place, turn, three('a', felt, '123'))
    topics = {one['topic']: one for one in yaml.safe_load(draft_mapping(path, {}).text)['topics']}
    assert topics['imu']['acceleration']['columns'] == ['a1', 'a2', 'a3']


def test_a_name_and_a_motion_that_contradict_each_other_are_asked(tmp_path):
    draft, _ = draft_commands(tmp_path / 'a.csv', 'cmd_x cmd_yaw cmd_z')
    assert list_asked(draft) == ['cmd_yaw.command', 'cmd_z.command']


@pytest.mark.parametrize('names', ['u1 u2 u3', 'tau1 tau2 tau3', 'F1 F2 F3'])
def test_two_numbers_that_push_ahead_and_turn_are_rotors(tmp_path, names):
    orders, place, turn = fly_commands()
    ahead, up, left = (orders / np.abs(orders).max(axis=0)).T
    rotors = (ahead - left, ahead + left, up)
    path = write_motion(
        tmp_path / 'a.csv', place, turn, dict(zip(names.split(), rotors, strict=True))
    )
    draft = draft_mapping(path, {})
    assert list_asked(draft) == []
    (motors,) = [one for one in yaml.safe_load(draft.text)['topics'] if one['topic'] == 'motors']
    assert [*motors['actuators']] == names.lower().split()


@pytest.mark.parametrize('names', ['cmd_x cmd_z cmd_yaw', 'u1 u2 u3'])
def test_a_place_that_the_vehicle_reaches_is_no_force(tmp_path, names):
    rng = np.random.default_rng(0)
    targets = np.repeat(rng.uniform(-1.0, 1.0, (20, 3)), 125, axis=0) * [1.0, 0.5, 2.0]
    state, speed, states = np.zeros(3), np.zeros(3), []
    for target in targets:
        speed = speed + STEP * (1.5 * (target - state) - 1.6 * speed)
        state = state + STEP * speed
        states.append(state)
    x, z, heading = np.array(states).T
    lean = 0.02 * np.sin(2.0 * np.arange(len(x)) * STEP)
    turn = Rotation.from_euler('ZY', np.column_stack([heading, lean]))
    place = np.column_stack([x, 0.0 * x, z])
    commands = dict(zip(names.split(), targets.T, strict=True))
    draft = draft_mapping(write_motion(tmp_path / 'a.csv', place, turn, commands), {})
    assert list_asked(draft) == [f'{name}.command' for name in names.split()]
