# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Find poses that a tracker took from other markers or bodies: changes that no inertia allows."""

from typing import Any, Final

from lta_data.importers.protocol import Numbers
import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d
from scipy.spatial.transform import Rotation

LONGEST_JUMP: Final = 1.5  # of a jump [s]
CHANGE_WINDOW: Final = 15  # changes; width of the median filter that gives the usual one
# Median of the absolute value of white noise, in standard deviations
MEDIAN_OF_NOISE: Final = 0.6745
JUMP_DEVIATIONS: Final = 12.0  # standard deviations off the usual change
MIN_JUMP: Final = 0.02  # m, or quaternion component
GAP_ACCELERATION: Final = 0.5  # that a vehicle may accelerate within a gap [m/s2]
RETURNS: Final = 0.5  # of the jump, at most, that the pose behind it is off
MAX_BODIES_IN_TURN: Final = 4  # that a tracker may report in turn
QUIET_QUANTILE: Final = 0.2  # quantile of the changes that no jump has, however many there are
QUIET_NOISE: Final = 1.0  # that quantile of the length of white noise, in standard deviations
BURST: Final = 2.0  # times its usual speed a vehicle changes its speed from pose to pose, at most


def find_steps(time: Numbers, poses: Numbers, least: float) -> tuple[Any, Numbers]:
    """
    Return which changes from pose to pose no inertia allows, and by how much they are off.

    A vehicle keeps its speed from one pose to the next, but for noise and for what a collision
    takes away. Where a tracker reports several bodies in turn, each keeps its own.

    `time`: increasing, shape (n,) [s]. `poses`: positions, shape (n, 3) [m], or quaternions,
    shape (n, 4). `least`: size of a step [m or rad].
    """
    count = len(time) - 1
    slopes, usual = [], []
    for apart in range(1, MAX_BODIES_IN_TURN + 1):
        change, step = _measure_changes(poses, apart), (time[apart:] - time[:-apart])[:, None]
        # Not the median of quotients, since messages that come together have no time between them
        way = median_filter(change, size=(CHANGE_WINDOW, 1), mode='nearest')
        slope = way / uniform_filter1d(step, CHANGE_WINDOW, axis=0, mode='nearest')
        usual.append(np.quantile(np.linalg.norm(change - way, axis=1), QUIET_QUANTILE))
        slopes.append(np.pad(slope, ((0, count - len(slope)), (0, 0)), mode='edge'))
    paces = np.array([np.linalg.norm(slope, axis=1) for slope in slopes])
    # Where bodies alternate, the speed from one pose to the next of the same body is the true one
    slope = np.array(slopes)[paces.argmin(axis=0), np.arange(count)]
    step = np.diff(time)
    off = np.linalg.norm(_measure_changes(poses, 1) - slope * step[:, None], axis=1)
    fast = float(np.quantile(paces.min(axis=0), 0.75))
    allowed = np.maximum(
        JUMP_DEVIATIONS * min(usual) / QUIET_NOISE,
        BURST * fast * np.maximum(step, np.median(step)),
    )
    return off > np.maximum(allowed + GAP_ACCELERATION * step**2, least), off


def _measure_changes(poses: Numbers, apart: int) -> Numbers:
    """Return ways [m], or turns [rad], between poses so many rows apart, shape (n - apart, 3)."""
    if poses.shape[1] == 3:
        return np.asarray(poses[apart:] - poses[:-apart])
    turn = Rotation.from_quat(poses)
    return (turn[:-apart].inv() * turn[apart:]).as_rotvec()


def find_tracker_jumps(time: Numbers, poses: Numbers) -> Any:
    """
    Return a mask of the poses between a jump and the jump back.

    `time`: rising, shape (n,) [s]. `poses`, shape (n, k): positions [m], or quaternions without
    sign changes. A jump that does not return is not marked, as nothing tells which side is right.
    """
    out = np.zeros(len(poses), dtype=np.bool_)
    rows = np.flatnonzero(np.isfinite(poses).all(axis=1))
    if len(rows) < 2 * CHANGE_WINDOW:
        return out
    at, whole = time[rows], poses[rows]
    change, step = np.diff(whole, axis=0), np.diff(at)[:, None]
    slope = median_filter(change / step, size=(CHANGE_WINDOW, 1), mode='nearest')
    off = np.abs(change - slope * step)
    usual = np.median(off, axis=0) / MEDIAN_OF_NOISE
    far = off / np.maximum(JUMP_DEVIATIONS * usual, MIN_JUMP + GAP_ACCELERATION * step**2)
    jumps = np.flatnonzero((far > 1.0).any(axis=1))
    done = -1
    for index, begin in enumerate(jumps.tolist()):
        later = jumps[index + 1 :]
        later = later[at[later + 1] - at[begin] <= LONGEST_JUMP]
        if begin < done or not len(later):
            continue
        size = far[begin].max() * np.maximum(JUMP_DEVIATIONS * usual, MIN_JUMP)
        # By the speeds on both sides, which a curve needs
        speed = 0.5 * (slope[begin] + slope[later])
        expected = whole[begin] + speed * (at[later + 1] - at[begin])[:, None]
        back = later[(np.abs(whole[later + 1] - expected) < RETURNS * size).all(axis=1)]
        if len(back):
            done = int(back[0])
            out[rows[begin + 1 : done + 1]] = True
    return out
