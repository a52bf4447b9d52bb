# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Forces are read along the axes in which the vehicle follows them, whatever those of the pose."""

from lta_data.importers.draft.draft_mapping import draft_mapping
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
import yaml

from .lab_flights import DOWN, three, write_csv

STEP = 0.02


def fly_commands(responds=True):
    """Return commands ahead, up and to the left, and the places and angles that follow them."""
    rng = np.random.default_rng(1)
    held = np.repeat(rng.choice([-1.0, -0.5, 0.0, 0.5, 1.0], (27, 3)), 75, axis=0)[:2000]
    orders = held * [0.06, 0.04, 0.004]
    place, speed, yaw, rate = np.array([0.3, -0.2, 1.6]), np.zeros(2), 0.4, 0.0
    rows = []
    for ahead, up, turn in orders if responds else np.zeros_like(orders):
        drag = (0.03 + 0.1 * np.abs(speed)) * speed
        speed = speed + STEP * ((ahead, up - 0.03 * (place[2] - 1.6)) - drag) / 0.35
        rate += STEP * (turn - 0.004 * rate) / 0.01
        yaw += STEP * rate
        place = place + STEP * np.array([np.cos(yaw) * speed[0], np.sin(yaw) * speed[0], speed[1]])
        rows.append([*place, yaw])
    table = np.array(rows)
    lean = 0.02 * np.sin(2.0 * np.arange(len(table)) * STEP)
    return orders, table[:, :3], Rotation.from_euler('ZY', np.column_stack([table[:, 3], lean]))


def write_flight(
    path, *, pose_down, force_down, responds=True, scale=1.0, names=('fx_N', 'fz_N', 'tz_Nm')
):
    """Write a flight with z of the poses and of the forces up or down, and scaled forces."""
    orders, place, turn = fly_commands(responds)
    place = place * DOWN if pose_down else place
    quaternion = turn.as_quat() * (np.append(DOWN, 1.0) if pose_down else 1.0)
    sign = -1.0 if force_down else 1.0
    noise = np.random.default_rng(2).normal(0.0, 3e-4, place.shape)
    return write_csv(path, {
        't': 9.0 + STEP * np.arange(len(place)), **three('p', place + noise),
        **three('q', quaternion, 'xyzw'),
        **dict(zip(names, (scale * orders * [1.0, sign, sign]).T, strict=True)),
    })  # fmt: skip


def assert_commands_are_those_flown(recording):
    """Compare some imported commands with those of the flight."""
    got, orders = recording.messages['/lta1/wrench_command'], fly_commands()[0]
    for k in (100, 700, 1500):
        wrench = got[k].wrench
        assert (wrench.force.x, wrench.force.z, wrench.torque.z) == pytest.approx(
            tuple(orders[k]), abs=1e-9
        )


@pytest.mark.parametrize('force_down', [False, True])
@pytest.mark.parametrize('pose_down', [False, True])
def test_forces_have_the_axes_in_which_the_vehicle_follows(tmp_path, bring, pose_down, force_down):
    source = write_flight(tmp_path / 'a.csv', pose_down=pose_down, force_down=force_down)
    draft = draft_mapping(source, {})
    assert draft.choices.questions == []
    assert_commands_are_those_flown(bring(source, draft.text))
    said = [one.reason for one in draft.choices.reasons if one.part == 'wrench_command: axes']
    way = 'down or to the right' if force_down else 'up or to the left'
    assert said == (
        [f'the vehicle accelerates {way} with them'] if pose_down != force_down else []
    )


def test_a_vehicle_that_does_not_follow_decides_nothing(tmp_path):
    source = write_flight(tmp_path / 'a.csv', pose_down=True, force_down=False, responds=False)
    topics = yaml.safe_load(draft_mapping(source, {'world.up': 'down'}).text)['topics']
    assert ['body' in one for one in topics] == [False, False]


@pytest.mark.parametrize(
    ('names', 'scale', 'unit'),
    [
        (('force_x', 'force_z', 'torque_z'), 1000.0, 'mN'),
        (('fx_N', 'fz_N', 'tz_Nm'), 1000.0, 'mN'),
        (('fx_mN', 'fz_mN', 'tz_mNm'), 1.0, 'N'),
        (('force_x', 'force_z', 'torque_z'), 1.0, ''),
        (('fx_mN', 'fz_mN', 'tz_mNm'), 1000.0, ''),
    ],
)
def test_the_mass_that_a_force_accelerates_tells_newtons_from_millinewtons(
    tmp_path, bring, names, scale, unit
):
    """The vehicle has 0.35 kg. Names without a unit are overruled, others lead to a question."""
    source = write_flight(
        tmp_path / 'a.csv', pose_down=False, force_down=False, scale=scale, names=names
    )
    draft = draft_mapping(source, {})
    asked = [one.key for one in draft.choices.questions]
    assert asked == (['wrench_command.unit'] if unit and 'force_x' not in names else [])
    assert_commands_are_those_flown(bring(source, draft.text))
    said = [one for one in draft.choices.reasons if one.part == 'wrench_command: unit']
    assert [one.reading for one in said] == ([unit] if unit else [])
    if unit:
        mass = float(said[0].reason.partition('a mass of ')[2].partition(' kg')[0])
        assert mass == pytest.approx(0.35, rel=0.2)
