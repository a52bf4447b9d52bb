# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Relate the poses of an external tracker, in the map, to the estimate, in the odom frame.

The estimator wants the tracked position in its own frame, whose heading drifts with the gyroscope:
`TrackedPath` adds up the tracked ways, each turned by the newest difference of the headings, so
that odom stays continuous. A drone that flies to places in the map wants its motion there:
`Locator` has it from the newest tracked pose and the estimate since then.
"""

import math
from typing import final, NamedTuple

from lta_control.motion import wrap_angle

Pair = tuple[float, float]

# ns without a tracked pose after which the tracker is lost: the estimate goes on for that long
LOST_NS = 2_000_000_000
WIND_TIME = 2.0  # s; filter of the difference between the velocities over ground and through air


class TrackedMotion(NamedTuple):
    """A pose by the tracker, with its velocity."""

    stamp_ns: int  # [ns]
    position: Pair  # [m, map]
    yaw: float  # [rad, map]
    velocity: Pair  # over ground [m/s, map]


class OdomMotion(NamedTuple):
    """Motion by the estimator."""

    stamp_ns: int  # [ns]
    position: Pair  # [m, odom]
    yaw: float  # [rad, odom]
    yaw_rate: float  # [rad/s]
    velocity: Pair  # over ground [m/s, odom]
    air: Pair  # velocity through the air [m/s, odom]


class LocatedMotion(NamedTuple):
    """Motion in the frame in which the drone holds places: map with a tracker, else odom."""

    position: Pair  # [m]
    velocity: Pair  # over ground [m/s]
    wind: Pair  # velocity over ground less that through the air [m/s]
    heading: float  # [rad]
    turn: float  # heading in odom less that in the frame [rad]
    tracked: bool


class MapAnchor(NamedTuple):
    """The same place in both frames at one time, and the heading in odom less that in map."""

    stamp_ns: int
    turn: float
    place: Pair  # [m, map]
    odom: Pair  # [m, odom]


def rotate(pair: Pair, angle: float) -> Pair:
    """Return a vector that is turned counter-clockwise by an angle [rad]."""
    cos, sin = math.cos(angle), math.sin(angle)
    return cos * pair[0] - sin * pair[1], sin * pair[0] + cos * pair[1]


def anchor_map(tracked: TrackedMotion, motion: OdomMotion) -> MapAnchor:
    """Return what a tracked pose says of the time of an estimate, which is a little later."""
    age = min(max(motion.stamp_ns - tracked.stamp_ns, 0), LOST_NS) * 1e-9
    x, y = tracked.position
    place = x + age * tracked.velocity[0], y + age * tracked.velocity[1]
    turn = wrap_angle(motion.yaw - age * motion.yaw_rate - tracked.yaw)
    return MapAnchor(motion.stamp_ns, turn, place, motion.position)


@final
class TrackedPath:
    """The way of the tracked drone in odom; the first pose counts as where the estimate is."""

    def __init__(self) -> None:
        self._last: MapAnchor | None = None  # its `odom` is the tracked position

    def follow(self, tracked: TrackedMotion, motion: OdomMotion, ready: bool) -> Pair:
        """Return the tracked position at the time of the estimate; not `ready`, it begins anew."""
        now, last = anchor_map(tracked, motion), self._last
        if last is not None and ready:
            moved = now.place[0] - last.place[0], now.place[1] - last.place[1]
            x, y = rotate(moved, now.turn)
            now = now._replace(odom=(last.odom[0] + x, last.odom[1] + y))
        self._last = now
        return now.odom


@final
class Locator:
    """The motion of the drone in the map, or in odom without a tracker or after its loss."""

    def __init__(self) -> None:
        self._anchor: MapAnchor | None = None
        self._wind: Pair | None = None  # [m/s, odom]
        self._last_ns = 0

    def locate(self, motion: OdomMotion, tracked: TrackedMotion | None) -> LocatedMotion:
        """Return the motion from an estimate and the tracked pose that is new, if there is one."""
        if tracked is not None:
            self._anchor = anchor_map(tracked, motion)
        raw = motion.velocity[0] - motion.air[0], motion.velocity[1] - motion.air[1]
        x, y = self._wind or raw
        dt = max(motion.stamp_ns - self._last_ns, 0) * 1e-9
        share = dt / (WIND_TIME + dt)
        wind = self._wind = x + share * (raw[0] - x), y + share * (raw[1] - y)
        self._last_ns = motion.stamp_ns
        anchor = self._anchor
        if anchor is None or not 0 <= motion.stamp_ns - anchor.stamp_ns <= LOST_NS:
            return LocatedMotion(motion.position, motion.velocity, wind, motion.yaw, 0.0, False)
        since = motion.position[0] - anchor.odom[0], motion.position[1] - anchor.odom[1]
        x, y = rotate(since, -anchor.turn)
        return LocatedMotion(
            (anchor.place[0] + x, anchor.place[1] + y),
            rotate(motion.velocity, -anchor.turn),
            rotate(wind, -anchor.turn),
            wrap_angle(motion.yaw - anchor.turn),
            anchor.turn,
            True,
        )
