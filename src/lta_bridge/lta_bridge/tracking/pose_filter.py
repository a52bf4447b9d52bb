"""
Reject implausible poses of a tracker.

Typical failures: a lost body gives NaN or an invalid attitude; the last pose is repeated; markers
of another body make the pose jump; the network reorders messages.
"""

from collections import Counter
from enum import StrEnum
import math
from typing import Final, final

from lta_bridge.one_way_clock import BACK_NS
from lta_bridge.tracking.pose import angle_between, TrackerPose

NORM_TOLERANCE: Final = 0.01  # tolerance of the quaternion's norm, enough for single precision
FASTEST_MOTION: Final = 5.0  # m/s; over five times the speed of these airships
FASTEST_ROTATION: Final = 10.0  # rad/s
STEP_TOLERANCE: Final = 0.05  # m and rad, tolerance of each step for noise
FROZEN_NS: Final = 500_000_000  # real poses have noise and do not repeat exactly for so long
FOUND_NS: Final = 200_000_000  # a jump that lasts this long is accepted as the true position


class PoseFault(StrEnum):
    """Reasons to reject a pose."""

    NOT_A_NUMBER = 'not a number'
    NO_ATTITUDE = 'no attitude'
    NO_STAMP = 'no stamp'
    OLD = 'old'
    FROZEN = 'frozen'
    LEAP = 'leap'


Stamped = tuple[int, TrackerPose]


@final
class PoseFilter:
    """
    Accept or reject poses as they arrive.

    `noisy`: whether they have noise, so that one that repeats exactly is an old one.

    Attributes
    ----------
    faults : Counter
        Number of rejected poses by fault.
    newest : PoseFault or None
        Why the last pose was rejected; None if it was accepted.
    found : int
        Number of jumps that were accepted in the end.
    set_back : int
        Number of times that the tracker's clock was set back.

    """

    def __init__(self, *, noisy: bool = True) -> None:
        self._noisy = noisy
        self.faults: Counter[PoseFault] = Counter()
        self.newest: PoseFault | None = None
        self.found = self.set_back = 0
        self._last: Stamped | None = None  # last accepted pose
        self._leapt: list[Stamped] = []  # first and last pose after a jump that are consistent
        self._since = 0  # stamp since which the pose has not changed

    def accept_pose(self, stamp_ns: int, pose: TrackerPose) -> bool:
        """Return whether to accept a pose; count the rejected ones."""
        self.newest = self._find_pose_fault(stamp_ns, pose)
        if self.newest is not None:
            self.faults[self.newest] += 1
        return self.newest is None

    def _find_pose_fault(self, stamp_ns: int, pose: TrackerPose) -> PoseFault | None:
        if not all(map(math.isfinite, (*pose.place, *pose.turn))):
            return PoseFault.NOT_A_NUMBER
        if abs(math.hypot(*pose.turn) - 1.0) > NORM_TOLERANCE:
            return PoseFault.NO_ATTITUDE
        if stamp_ns <= 0:
            return PoseFault.NO_STAMP
        if self._last is not None and stamp_ns <= self._last[0]:
            # A little older: reordered; much older: the tracker's clock was set back
            if stamp_ns > self._last[0] - BACK_NS:
                return PoseFault.OLD
            self.set_back += 1
            self._last = None
        return self._find_motion_fault(stamp_ns, pose)

    def _find_motion_fault(self, stamp_ns: int, pose: TrackerPose) -> PoseFault | None:
        """Return the motion fault of a valid pose that is later than all before, if any."""
        last = self._last
        if last is None or pose != last[1]:
            self._since = stamp_ns
        elif self._noisy and stamp_ns - self._since > FROZEN_NS:
            # Its stamp is valid, so that older poses stay rejected
            self._last = (stamp_ns, pose)
            return PoseFault.FROZEN
        if last is None or is_reachable(last, (stamp_ns, pose)):
            self._leapt = []
        elif not self._has_settled(stamp_ns, pose):
            return PoseFault.LEAP
        self._last = (stamp_ns, pose)
        return None

    def _has_settled(self, stamp_ns: int, pose: TrackerPose) -> bool:
        """Return whether the poses after a jump have been consistent long enough to accept it."""
        now = (stamp_ns, pose)
        if not self._leapt or not is_reachable(self._leapt[-1], now):
            self._leapt = [now, now]
        self._leapt[-1] = now
        if stamp_ns - self._leapt[0][0] < FOUND_NS:
            return False
        self._leapt = []
        self.found += 1
        return True


def is_reachable(before: Stamped, after: Stamped) -> bool:
    """Return whether the drone can have moved from one pose to another."""
    dt = 1e-9 * (after[0] - before[0])
    earlier, later = before[1], after[1]
    near = math.dist(earlier.place, later.place) <= FASTEST_MOTION * dt + STEP_TOLERANCE
    angle = angle_between(earlier.turn, later.turn)
    return near and angle <= FASTEST_ROTATION * dt + STEP_TOLERANCE
