# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Jumps of a tracker are told from motion and from gaps."""

from lta_data.data_quality.recording import QualityFinding
from lta_data.data_quality.registry import run_checks
from lta_data.flight import Channel, Flight
from lta_data.interpretation.jumps import find_tracker_jumps
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]


def swerving(rate: float) -> tuple[Array, Array]:
    """Return 20 s at 1 m/s in curves, turning at 1 rad/s, with half a millimetre of noise."""
    time = np.arange(0.0, 20.0, 1.0 / rate)
    place = np.column_stack([np.sin(time), 1.0 - np.cos(time), 1.5 + 0.0 * time])
    turn = np.column_stack([0.0 * time, 0.0 * time, np.sin(0.5 * time), np.cos(0.5 * time)])
    noise = 5e-4 * np.random.default_rng(1).standard_normal((len(time), 7))
    return time, np.hstack([place, turn]) + noise


def list_rows(time: Array, poses: Array) -> list[int]:
    found: list[int] = np.flatnonzero(find_tracker_jumps(time, poses)).tolist()
    return found


@pytest.mark.parametrize('rate', [20.0, 60.0, 240.0])
def test_a_vehicle_that_swerves_does_not_jump(rate: float) -> None:
    assert list_rows(*swerving(rate)) == []


def test_what_lies_between_a_jump_and_the_jump_back_is_marked() -> None:
    time, poses = swerving(100.0)
    poses[300:340, 0] += 0.08
    poses[900:905, 3:] = [0.2, 0.0, 0.0, 0.98]
    assert list_rows(time, poses) == [*range(300, 340), *range(900, 905)]


def test_a_jump_that_does_not_return_or_stays_for_long_is_not_judged() -> None:
    time, poses = swerving(100.0)
    poses[300:500, 0] += 0.1  # 2 s
    poses[900:, 1] += 0.1
    assert list_rows(time, poses) == []


def test_a_gap_is_no_jump_and_one_beside_a_gap_is_found() -> None:
    time, poses = swerving(100.0)
    kept = np.ones(len(time), dtype=bool)
    kept[500:560] = False
    assert list_rows(time[kept], poses[kept]) == []
    poses[1200:1220, 2] += 0.3
    kept[1190:1200] = False
    assert list_rows(time[kept], poses[kept]) == [*range(1130, 1150)]


def find_impossible(
    time: Array, place: Array, turn: Rotation, topic: str = 'ground_truth/odom'
) -> list[QualityFinding]:
    """Return what `lta bag check` calls impossible in a pose."""
    parts = {'position': (place, 'xyz'), 'orientation': (turn.as_quat(), 'xyzw')}
    channels = {
        (name := f'{topic}/pose.pose.{part}.{axis}'): Channel(name, '', time, values[:, k].copy())
        for part, (values, axes) in parts.items()
        for k, axis in enumerate(axes)
    }
    report = run_checks(Flight(channels, {'data': 'measured'}))
    return [one for one in report.findings if one.kind == 'impossible']


def circling(rate: float, speed: float = 0.5) -> tuple[Array, Array, Rotation]:
    """Return 40 s of an airship in circles of 1.5 m, with half a millimetre of noise."""
    rng = np.random.default_rng(2)
    time = np.arange(0.0, 40.0, 1.0 / rate)
    course = speed / 1.5 * time
    place = 1.5 * np.column_stack([np.sin(course), -np.cos(course), 1.0 + 0.1 * np.sin(time)])
    angles = np.column_stack([course, 0.1 * np.sin(2.0 * time), 0.05 * np.cos(time)])
    place += rng.normal(0.0, 5e-4, place.shape)
    return time, place, Rotation.from_euler('ZYX', angles + rng.normal(0.0, 1e-3, angles.shape))


@pytest.mark.parametrize('rate', [10.0, 50.0, 200.0])
@pytest.mark.parametrize('speed', [0.05, 0.5, 1.5])
def test_an_airship_makes_no_impossible_step(rate: float, speed: float) -> None:
    assert find_impossible(*circling(rate, speed)) == []


@pytest.mark.parametrize('rate', [10.0, 50.0, 200.0])
@pytest.mark.parametrize('each', [2, 3, 7, 50])
def test_another_body_in_some_of_the_poses(rate: float, each: int) -> None:
    time, place, turn = circling(rate)
    place[::each] = [3.0, 3.0, 0.0]
    (finding, *_) = find_impossible(time, place, turn)
    assert 'jumps' in finding.evidence


@pytest.mark.parametrize('rate', [10.0, 50.0, 200.0])
@pytest.mark.parametrize('bodies', [3, 4])
def test_several_bodies_in_turn(rate: float, bodies: int) -> None:
    time, place, turn = circling(rate)
    place += np.arange(len(time))[:, None] % bodies * np.array([1.0, 0.4, 0.0])
    assert find_impossible(time, place, turn)


@pytest.mark.parametrize('size', [0.05, 0.3])
def test_a_step_that_stays(size: float) -> None:
    time, place, turn = circling(50.0)
    place[1000:, 0] += size
    (finding,) = find_impossible(time, place, turn)
    assert finding.from_s == pytest.approx(time[1000])
    assert find_impossible(time, place, turn, 'odom') == []  # a corrected estimate


@pytest.mark.parametrize('rate', [20.0, 100.0])
def test_a_pose_that_freezes_and_jumps(rate: float) -> None:
    time, place, turn = circling(rate)
    for begin in np.flatnonzero(np.diff(time // 4.0)):
        held = slice(begin, begin + round(0.5 * rate))
        place[held] = place[begin]
    assert find_impossible(time, place, turn)


@pytest.mark.parametrize('rate', [10.0, 50.0])
@pytest.mark.parametrize('degrees', [90.0, 180.0])
def test_a_heading_that_turns_in_one_frame(rate: float, degrees: float) -> None:
    time, place, turn = circling(rate)
    half = len(time) // 2
    late = turn[half:] * Rotation.from_euler('z', degrees, degrees=True)
    (finding,) = find_impossible(time, place, Rotation.concatenate([turn[:half], late]))
    assert finding.from_s == pytest.approx(time[half], abs=0.2)
    assert f'{degrees:.0f} degrees' in finding.evidence


@pytest.mark.parametrize('share', [0.1, 0.3, 0.45, 1.0])
def test_two_poses_of_one_body_in_turn(share: float) -> None:
    time, place, turn = circling(50.0)
    odd = np.random.default_rng(3).random(len(time)) < share
    if share == 1.0:
        odd = np.arange(len(time)) % 2 == 0
    flipped = (turn * Rotation.from_euler('z', 180.0, degrees=True)).as_quat()
    turn = Rotation.from_quat(np.where(odd[:, None], flipped, turn.as_quat()))
    assert find_impossible(time, place, turn)


def test_a_collision_is_no_jump() -> None:
    time, place, turn = circling(50.0)
    place[1000:] = place[1000] + np.random.default_rng(1).normal(0.0, 5e-4, place[1000:].shape)
    assert find_impossible(time, place, turn) == []
