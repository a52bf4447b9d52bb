"""One tracked drone: its poses sieved, placed in the map, dated in our time, with motion."""

from collections.abc import Iterator
from typing import Final, final

from lta_bridge.one_way_clock import OneWayClock
from lta_bridge.tracking.motion import MotionWindow, TrackerMotion
from lta_bridge.tracking.pose import compose_poses, normalize_pose, TrackerPose
from lta_bridge.tracking.pose_filter import PoseFilter
from lta_graph.health import HealthFact, HealthLevel

TASK: Final = 'tracker'
SILENT_NS: Final = 500_000_000  # without a pose
RECENT_NS: Final = 1_000_000_000  # a refusal is told for so long, and counted for ever


@final
class TrackedDrone:
    """
    Make the truth of a tracker's poses.

    Parameters
    ----------
    origin : Pose
        The tracker's frame in the map.
    body : Pose
        The vehicle's frame in that of the tracked body.
    delay_ns : int
        What the fastest pose takes from the picture to here. [ns]

    Attributes
    ----------
    clock : OneWayClock
        The tracker's clock.
    sieve : Sieve
        What was not believed.
    window : Window
        What was waited for.

    """

    def __init__(self, origin: TrackerPose, body: TrackerPose, delay_ns: int) -> None:
        self._origin, self._body = origin, body
        self.clock, self.sieve, self.window = OneWayClock(), PoseFilter(), MotionWindow()
        self.clock.one_way_ns = delay_ns
        self._heard = self._refused = self._told = 0
        self._offset_ns = 0
        self._poses = 0

    def receive_pose(
        self, stamp_ns: int, pose: TrackerPose, arrival_ns: int
    ) -> Iterator[TrackerMotion]:
        """
        Take a pose, and yield what is known by it.

        Parameters
        ----------
        stamp_ns : int
            By the tracker's clock. [ns]
        pose : Pose
            Of the tracked body in the tracker's frame.
        arrival_ns : int
            When it came, graph time. [ns]

        Yields
        ------
        Motion
            Of the vehicle in the map, stamped in graph time, in order.

        """
        set_back, found = self.sieve.set_back, self.sieve.found
        self._poses += 1
        self._heard = arrival_ns
        if not self.sieve.accept_pose(stamp_ns, pose):
            self._refused = arrival_ns
            return
        if self.sieve.set_back > set_back:
            self.clock.restart()
        if (self.sieve.set_back, self.sieve.found) != (set_back, found):
            self.window.clear()
        restarts = self.clock.restarts
        self.clock.stamp_arrival(stamp_ns, arrival_ns)
        if self.clock.restarts > restarts:  # of two clocks one was set: ours, perhaps back
            self._told = 0
        self._offset_ns = stamp_ns - self.clock.to_graph_time(stamp_ns)
        placed = compose_poses(compose_poses(self._origin, normalize_pose(pose)), self._body)
        for motion in self.window.add_pose(stamp_ns, placed):
            ours = self.clock.to_graph_time(motion.stamp_ns)
            if ours > self._told:  # the line may still sink while the clock is learnt
                self._told = ours
                yield motion._replace(stamp_ns=ours)

    def describe_health(self, now_ns: int) -> HealthFact:
        """Return how the tracker is at a graph time [ns], with every count."""
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
            TASK, *self._assess_level(now_ns), {k: str(v) for k, v in figures.items()}
        )

    def _assess_level(self, now_ns: int) -> tuple[HealthLevel, str]:
        if not self._poses:
            return HealthLevel.WARN, 'no pose has come yet'
        if now_ns - self._heard > SILENT_NS:
            return HealthLevel.ERROR, f'silent for {1e-9 * (now_ns - self._heard):.1f} s'
        if self.sieve.newest is not None:
            return HealthLevel.ERROR, f'not believed: {self.sieve.newest}'
        if self._refused and now_ns - self._refused < RECENT_NS:
            return HealthLevel.WARN, 'some poses are not believed'
        return HealthLevel.OK, 'poses come'
