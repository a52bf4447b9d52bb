"""Compose and compare poses, and compute map -> odom from poses and estimates (REP-105)."""

from collections import deque
import math
from typing import Final, final, NamedTuple

Three = tuple[float, float, float]
Turn = tuple[float, float, float, float]


class TrackerPose(NamedTuple):
    """Position [m] and attitude of a frame in its parent."""

    place: Three
    turn: Turn


def build_level_pose(x: float, y: float, z: float, yaw: float) -> TrackerPose:
    """Return a level pose from position [m] and heading [rad]."""
    return TrackerPose((x, y, z), (0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)))


def normalize_pose(pose: TrackerPose) -> TrackerPose:
    """Return a pose with a unit quaternion."""
    x, y, z, w = pose.turn
    length = math.hypot(x, y, z, w)
    return TrackerPose(pose.place, (x / length, y / length, z / length, w / length))


def compose_poses(a: TrackerPose, b: TrackerPose) -> TrackerPose:
    """Return b, given in a's frame, in the parent frame of a."""
    x, y, z = rotate_vector(a.turn, b.place)
    return TrackerPose(
        (a.place[0] + x, a.place[1] + y, a.place[2] + z), _quaternion_product(a.turn, b.turn)
    )


def invert_pose(pose: TrackerPose) -> TrackerPose:
    """Return the pose of the parent frame in the frame of a pose."""
    x, y, z, w = pose.turn
    back = (-x, -y, -z, w)
    px, py, pz = rotate_vector(back, pose.place)
    return TrackerPose((-px, -py, -pz), back)


def rotate_vector(turn: Turn, v: Three) -> Three:
    """Rotate a vector by a quaternion."""
    x, y, z, _ = _quaternion_product(
        _quaternion_product(turn, (*v, 0.0)), (-turn[0], -turn[1], -turn[2], turn[3])
    )
    return x, y, z


def angle_between(a: Turn, b: Turn) -> float:
    """Return the angle between two attitudes, 0 to pi. [rad]"""
    x, y, z, w = _quaternion_product((-a[0], -a[1], -a[2], a[3]), b)
    return 2.0 * math.atan2(math.hypot(x, y, z), abs(w))


def _quaternion_product(p: Turn, q: Turn) -> Turn:
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return (
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
        pw * qw - px * qx - py * qy - pz * qz,
    )


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
