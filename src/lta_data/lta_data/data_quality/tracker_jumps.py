"""Find where a tracker jumps: markers that were lost, or mistaken for others."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

Array = NDArray[np.float64]

LONGEST: Final = 1.5  # of a jump [s]
AROUND: Final = 15  # changes; width of the median filter that gives the usual one
HALF: Final = 0.6745  # median of the absolute value of white noise, in standard deviations
CLEAR: Final = 12.0  # standard deviations off the usual change
LEAST: Final = 0.02  # m, or quaternion component
REACH: Final = 0.5  # that a vehicle may accelerate within a gap [m/s2]
RETURNS: Final = 0.5  # of the jump, at most, that the pose behind it is off
QUIET: Final = 0.3  # quantile of the changes that no jump has, however many there are
NOISE: Final = 1.19  # that quantile of the length of white noise, in standard deviations
BURST: Final = 2.0  # times its usual speed a vehicle changes its speed from pose to pose, at most


def find_steps(time: Array, changes: Array, least: float) -> tuple[Any, Array]:
    """
    Return which changes from pose to pose no inertia allows, and by how much they are off.

    A vehicle keeps its speed from one pose to the next, but for noise and for what a collision
    takes away. So does one of two bodies that a tracker reports in turn, over two poses.

    `time`: increasing, shape (n,) [s]. `changes`, shape (n - 1, 3): ways [m] or turns [rad].
    `least`: size of a step [m or rad].
    """
    step = np.diff(time)[:, None]
    ways = [(changes, step)]
    if len(changes) > AROUND:
        # Back to the same of two bodies, if they alternate
        ways.append((changes[1:] + changes[:-1], step[1:] + step[:-1]))
    slopes, usual = [], []
    for change, lasting in ways:
        slope = median_filter(change / lasting, size=(AROUND, 1), mode='nearest')
        usual.append(np.quantile(np.linalg.norm(change - slope * lasting, axis=1), QUIET))
        slopes.append(np.pad(slope, ((0, len(changes) - len(slope)), (0, 0)), mode='edge'))
    paces = np.array([np.linalg.norm(slope, axis=1) for slope in slopes])
    # Where poses of two bodies alternate, the speed over two poses is the true one
    slope = np.array(slopes)[paces.argmin(axis=0), np.arange(len(changes))]
    off, pace = np.linalg.norm(changes - slope * step, axis=1), paces.min(axis=0)
    fast = float(np.quantile(pace, 0.75))
    allowed = np.maximum(CLEAR * min(usual) / NOISE, BURST * fast * step[:, 0])
    return off > np.maximum(allowed + REACH * step[:, 0] ** 2, least), off


def find_tracker_jumps(time: Array, poses: Array) -> Any:  # noqa: ANN401 - an array of bool
    """
    Return a mask of the poses between a jump and the jump back.

    `time`: rising, shape (n,) [s]. `poses`, shape (n, k): positions [m], or quaternions without
    sign changes. A jump that does not return is not marked, as nothing tells which side is right.
    """
    out = np.zeros(len(poses), dtype=np.bool_)
    rows = np.flatnonzero(np.isfinite(poses).all(axis=1))
    if len(rows) < 2 * AROUND:
        return out
    at, whole = time[rows], poses[rows]
    change, step = np.diff(whole, axis=0), np.diff(at)[:, None]
    slope = median_filter(change / step, size=(AROUND, 1), mode='nearest')
    off = np.abs(change - slope * step)
    usual = np.median(off, axis=0) / HALF
    far = off / np.maximum(CLEAR * usual, LEAST + REACH * step**2)
    jumps = np.flatnonzero((far > 1.0).any(axis=1))
    done = -1
    for index, begin in enumerate(jumps.tolist()):
        later = jumps[index + 1 :]
        later = later[at[later + 1] - at[begin] <= LONGEST]
        if begin < done or not len(later):
            continue
        size = far[begin].max() * np.maximum(CLEAR * usual, LEAST)
        # By the speeds on both sides, which a curve needs
        speed = 0.5 * (slope[begin] + slope[later])
        expected = whole[begin] + speed * (at[later + 1] - at[begin])[:, None]
        back = later[(np.abs(whole[later + 1] - expected) < RETURNS * size).all(axis=1)]
        if len(back):
            done = int(back[0])
            out[rows[begin + 1 : done + 1]] = True
    return out
