"""Process the poses of one tracked drone: filter, transform to the map, stamp, differentiate."""

from collections.abc import Iterator
from typing import Final, final

from lta_bridge.one_way_clock import OneWayClock
from lta_bridge.tracking.motion import MotionWindow, TrackerMotion
from lta_bridge.tracking.pose import compose_poses, normalize_pose, TrackerPose
from lta_bridge.tracking.pose_filter import PoseFilter
from lta_graph.health import HealthFact, HealthLevel

TRACKER_TASK: Final = 'tracker'
SILENT_NS: Final = 500_000_000  # time without a pose that counts as an error
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
        placed = compose_poses(compose_poses(self._origin, normalize_pose(pose)), self._body)
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
        if now_ns - self._arrival_ns > SILENT_NS:
            return HealthLevel.ERROR, f'no pose for {1e-9 * (now_ns - self._arrival_ns):.1f} s'
        if self.sieve.newest is not None:
            return HealthLevel.ERROR, f'pose rejected: {self.sieve.newest}'
        if self._refused and now_ns - self._refused < RECENT_NS:
            return HealthLevel.WARN, 'some poses were rejected'
        return HealthLevel.OK, 'poses arrive'
