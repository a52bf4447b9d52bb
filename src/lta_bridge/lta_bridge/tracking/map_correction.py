"""Compute map -> odom from tracked poses and estimates, as REP-105 defines it."""

from collections import deque
import math
from typing import Final, final

from lta_bridge.tracking.pose import compose_poses, invert_pose, TrackerPose

KEPT_NS: Final = 2_000_000_000  # of estimates; a tracked pose is known 50 ms late, or more
NEAR_NS: Final = 50_000_000  # farther from a tracked pose, an estimate says nothing about it


@final
class MapCorrection:
    """Keep the newest estimates, and compare each tracked pose with the one of its time."""

    def __init__(self) -> None:
        self._estimates: deque[tuple[int, TrackerPose]] = deque()

    def add_estimate(self, stamp_ns: int, pose: TrackerPose) -> None:
        """Add the pose of base_link in odom; a stamp before the last one starts anew. [ns]"""
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
