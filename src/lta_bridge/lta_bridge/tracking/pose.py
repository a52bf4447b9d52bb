# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compose and compare poses, and compute map -> odom from poses and estimates (REP-105)."""

from collections import deque
import math
from typing import Final, final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Three = tuple[float, float, float]
Turn = tuple[float, float, float, float]


class TrackerPose(NamedTuple):
    """Position [m] and attitude of a frame in its parent."""

    place: Three
    turn: Turn


def build_level_pose(x: float, y: float, z: float, yaw: float) -> TrackerPose:
    """Return a level pose from position [m] and heading [rad]."""
    return TrackerPose((x, y, z), (0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)))


def compose_poses(a: TrackerPose, b: TrackerPose) -> TrackerPose:
    """Return b, given in a's frame, in the parent frame of a; its quaternion has length 1."""
    turn = Rotation.from_quat(a.turn)
    return _build_pose(turn.apply(b.place) + a.place, turn * Rotation.from_quat(b.turn))


def invert_pose(pose: TrackerPose) -> TrackerPose:
    """Return the pose of the parent frame in the frame of a pose."""
    back = Rotation.from_quat(pose.turn).inv()
    return _build_pose(-back.apply(pose.place), back)


def _build_pose(place: NDArray[np.float64], turn: Rotation) -> TrackerPose:
    return TrackerPose(tuple(place.tolist()), tuple(turn.as_quat().tolist()))


def angle_between(a: Turn, b: Turn) -> float:
    """Return the angle between two attitudes, 0 to pi [rad]."""
    return float((Rotation.from_quat(a).inv() * Rotation.from_quat(b)).magnitude())


KEPT_NS: Final = 2_000_000_000  # of estimates; a tracked pose is known 50 ms late, or more
NEAR_NS: Final = 50_000_000  # farther from a tracked pose, an estimate says nothing about it


@final
class MapCorrection:
    """Keep the newest estimates, and compare each tracked pose with the one of its time."""

    def __init__(self) -> None:
        self._estimates: deque[tuple[int, TrackerPose]] = deque()

    def add_estimate(self, stamp_ns: int, pose: TrackerPose) -> None:
        """Add the pose of base_link in odom; a stamp before the last one starts anew [ns]."""
        if not all(map(math.isfinite, (*pose.place, *pose.turn))):
            return
        if self._estimates and stamp_ns < self._estimates[-1][0]:
            self._estimates.clear()
        self._estimates.append((stamp_ns, pose))
        while stamp_ns - self._estimates[0][0] > KEPT_NS:
            self._estimates.popleft()

    def locate_odom(self, stamp_ns: int, truth: TrackerPose) -> TrackerPose | None:
        """
        Return the pose of odom in the map, or None without an estimate of that time.

        `truth` is the pose of base_link in the map, `stamp_ns` its time. [ns]
        """
        nearest = min(self._estimates, key=lambda one: abs(one[0] - stamp_ns), default=(0, None))
        if nearest[1] is None or abs(nearest[0] - stamp_ns) > NEAR_NS:
            return None
        return compose_poses(truth, invert_pose(nearest[1]))
