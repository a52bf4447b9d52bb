"""
What of a tracker's poses can be believed.

Trackers fail in few ways: they say no number, or no attitude, where a body is lost; they repeat
the last pose; they take one body's markers for another's, so that it leaps; networks reorder.
"""

from collections import Counter
from enum import StrEnum
import math
from typing import Final, final

from lta_bridge.one_way_clock import BACK_NS
from lta_bridge.tracking.pose import angle_between, TrackerPose

UNIT: Final = 0.01  # by which an attitude may miss the length 1, so that single precision passes
SPEED: Final = 5.0  # m/s; no airship of these flies a fifth of it
SPIN: Final = 10.0  # rad/s
SLACK: Final = 0.05  # m and rad that noise may add to any step
FROZEN_NS: Final = 500_000_000  # real poses have noise: none repeats to the last bit so long
FOUND_NS: Final = 200_000_000  # a leap that is kept so long was one to the right place


class PoseFault(StrEnum):
    """Why a pose is not believed."""

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
    Judge poses as they come.

    Attributes
    ----------
    faults : Counter
        How many poses were refused, by fault.
    newest : Fault or None
        Why the last pose was refused, if it was.
    found : int
        How often it was somewhere else for good.
    set_back : int
        How often the tracker's clock was set back.

    """

    def __init__(self) -> None:
        self.faults: Counter[PoseFault] = Counter()
        self.newest: PoseFault | None = None
        self.found = self.set_back = 0
        self._last: Stamped | None = None  # believed
        self._leapt: list[Stamped] = []  # first and last of poses elsewhere that hang together
        self._since = 0  # stamp from which the same pose is said

    def accept_pose(self, stamp_ns: int, pose: TrackerPose) -> bool:
        """Tell whether a pose is believed; the others are counted."""
        self.newest = self._find_fault(stamp_ns, pose)
        if self.newest is not None:
            self.faults[self.newest] += 1
        return self.newest is None

    def _find_fault(self, stamp_ns: int, pose: TrackerPose) -> PoseFault | None:
        if not all(map(math.isfinite, (*pose.place, *pose.turn))):
            return PoseFault.NOT_A_NUMBER
        if abs(math.hypot(*pose.turn) - 1.0) > UNIT:
            return PoseFault.NO_ATTITUDE
        if stamp_ns <= 0:
            return PoseFault.NO_STAMP
        if self._last is not None and stamp_ns <= self._last[0]:
            if stamp_ns > self._last[0] - BACK_NS:
                return PoseFault.OLD
            self.set_back += 1
            self._last = None
        return self._find_motion_fault(stamp_ns, pose)

    def _find_motion_fault(self, stamp_ns: int, pose: TrackerPose) -> PoseFault | None:
        """Return the fault of a pose that is one, later than all before."""
        last = self._last
        if last is None or pose != last[1]:
            self._since = stamp_ns
        elif stamp_ns - self._since > FROZEN_NS:
            self._last = (stamp_ns, pose)
            return PoseFault.FROZEN
        if last is None or is_reachable(last, (stamp_ns, pose)):
            self._leapt = []
        elif not self._has_settled(stamp_ns, pose):
            return PoseFault.LEAP
        self._last = (stamp_ns, pose)
        return None

    def _has_settled(self, stamp_ns: int, pose: TrackerPose) -> bool:
        """Tell whether poses elsewhere hang together so long that it is there."""
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
    """Tell whether the drone can have come from one pose to another."""
    dt = 1e-9 * (after[0] - before[0])
    near = math.dist(before[1].place, after[1].place) <= SPEED * dt + SLACK
    return near and angle_between(before[1].turn, after[1].turn) <= SPIN * dt + SLACK
