# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Process the poses of one tracked drone: filter, transform to the map, stamp, differentiate."""

from collections import Counter
from collections.abc import Iterator
from enum import StrEnum
import math
from typing import Final, final

from lta_bridge.one_way_clock import OneWayClock, SET_BACK_NS
from lta_bridge.tracking.motion import MotionWindow, TrackerMotion
from lta_bridge.tracking.pose import angle_between, compose_poses, TrackerPose
from lta_graph.health import HealthFact, HealthLevel

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
            if stamp_ns > self._last[0] - SET_BACK_NS:
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


TRACKER_TASK: Final = 'tracker'
SILENT_TRACKER_NS: Final = 500_000_000  # time without a pose that counts as an error
RECENT_NS: Final = 1_000_000_000  # a rejection is reported this long


@final
class TrackedDrone:
    """
    Convert a tracker's poses to the vehicle's motion in the map.

    `origin`: the tracker's frame in the map. `body`: the vehicle's frame in that of the tracked
    body. `delay_ns`: shortest delay from exposure to arrival of a pose [ns]. `noisy`: as in
    `PoseFilter`.
    """

    def __init__(
        self, origin: TrackerPose, body: TrackerPose, delay_ns: int, *, noisy: bool = True
    ) -> None:
        self._origin, self._body = origin, body
        self.clock, self.sieve = OneWayClock(), PoseFilter(noisy=noisy)
        self.window = MotionWindow()
        self.clock.one_way_ns = delay_ns
        self._arrival_ns = self._refused = self._stamp_ns = 0
        self._offset_ns = 0
        self._poses = 0

    def receive_pose(
        self, stamp_ns: int, pose: TrackerPose, arrival_ns: int
    ) -> Iterator[TrackerMotion]:
        """
        Add a pose and yield the motions that it completes.

        Parameters
        ----------
        stamp_ns : int
            Stamp by the tracker's clock. [ns]
        pose : TrackerPose
            Pose of the tracked body in the tracker's frame.
        arrival_ns : int
            Graph time of arrival. [ns]

        Yields
        ------
        TrackerMotion
            Motion of the vehicle in the map, stamped in graph time, in order.

        """
        set_back, found_before = self.sieve.set_back, self.sieve.found
        self._poses += 1
        self._arrival_ns = arrival_ns
        if not self.sieve.accept_pose(stamp_ns, pose):
            self._refused = arrival_ns
            return
        if self.sieve.set_back > set_back:
            self.clock.discard_estimate()
        # No derivative across a jump of the clock or of the position
        if (self.sieve.set_back, self.sieve.found) != (set_back, found_before):
            self.window.clear()
        restarts = self.clock.restarts
        self.clock.stamp_arrival(stamp_ns, arrival_ns)
        if self.clock.restarts > restarts:  # one of the two clocks was set; ours perhaps back
            self._stamp_ns = 0
        self._offset_ns = stamp_ns - self.clock.to_graph_time(stamp_ns)
        # Map <- tracker's frame <- tracked body <- hull centre
        placed = compose_poses(compose_poses(self._origin, pose), self._body)
        for motion in self.window.add_pose(stamp_ns, placed):
            ours = self.clock.to_graph_time(motion.stamp_ns)
            if ours > self._stamp_ns:  # stamps may step back while the clock is being estimated
                self._stamp_ns = ours
                yield motion._replace(stamp_ns=ours)

    def describe_health(self, now_ns: int) -> HealthFact:
        """Return the health of the tracker at a graph time [ns], with all counts."""
        sieve, clock = self.sieve, self.clock
        figures: dict[str, object] = {
            'poses': self._poses,
            **{fault.replace(' ', '_'): count for fault, count in sieve.faults.items()},
            'gaps': self.window.gaps,
            'found_elsewhere': sieve.found,
            'clock_set_back': sieve.set_back,
            'clock_restarts': clock.restarts,
            'clock_offset_s': f'{1e-9 * self._offset_ns:.6f}',
            'drift_ppm': f'{1e6 * clock.drift:.1f}',
        }
        return HealthFact(
            TRACKER_TASK, *self._assess_health(now_ns), {k: str(v) for k, v in figures.items()}
        )

    def _assess_health(self, now_ns: int) -> tuple[HealthLevel, str]:
        if not self._poses:
            return HealthLevel.WARN, 'no pose received yet'
        if now_ns - self._arrival_ns > SILENT_TRACKER_NS:
            return HealthLevel.ERROR, f'no pose for {1e-9 * (now_ns - self._arrival_ns):.1f} s'
        if self.sieve.newest is not None:
            return HealthLevel.ERROR, f'pose rejected: {self.sieve.newest}'
        if self._refused and now_ns - self._refused < RECENT_NS:
            return HealthLevel.WARN, 'some poses were rejected'
        return HealthLevel.OK, 'poses arrive'
