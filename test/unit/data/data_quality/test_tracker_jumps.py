"""Jumps of a tracker are told from motion and from gaps."""

from lta_data.data_quality.tracker_jumps import find_tracker_jumps
import numpy as np
from numpy.typing import NDArray
import pytest

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
