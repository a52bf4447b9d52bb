# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The goal of a flight: the target lamps in order, and when each was reached."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
import math
from typing import final

from lta_data.compare.sampling import wrap_angle
from lta_model.scenario import Scenario
from lta_report.curves import Array, FloorPoint, MotionCurve
from lta_sim.termination import build_goal, has_stayed, is_at_lamp
import numpy as np
from numpy.typing import NDArray

SAMPLED = 0.02  # s between samples of the truth: a flight may end before the one that shows it


def shortest_path_length(
    start: tuple[float, float], places: Sequence[tuple[float, float]], radius: float
) -> float:
    """Return the length of the shortest path from a start through all goal circles [m]."""
    way = np.array([start, *places])
    # Each leg is shorter than the distance of the lamps by a radius at both ends
    legs = np.hypot(*np.diff(way, axis=0).T) - 2.0 * radius
    legs[0] += radius  # the start is a point
    return float(np.maximum(legs, 0.0).sum())


@final
@dataclass(frozen=True)
class FlightGoal:
    """The goal of one flight."""

    scenario: Scenario | None  # the scene with its lamps, if known
    truth: MotionCurve | None  # the true motion, if known
    strategy: str = ''  # by which the drone navigated, if known

    @cached_property
    def places(self) -> list[FloorPoint]:
        """Return the target lamps in order; empty on a course, or if unknown."""
        if self.scenario is None or self.scenario.course is not None:
            return []
        return [FloorPoint(*lamp.position.vector[:2]) for lamp in self.scenario.target_lamps]

    @property
    def radius(self) -> float:
        """Horizontal distance that counts as reached; NaN if unknown [m]."""
        return np.nan if self.scenario is None else self.scenario.goal.radius.si

    @cached_property
    def arrivals(self) -> list[float]:
        """
        Return the times at which the lamps were reached, in order, as far as they were [s].

        A lamp counts only after those before it, so a round trip is not complete at its start. The
        last one counts when the drone has stayed there (`ScenarioGoal.find_stay`).
        """
        times, since, truth = list[float](), 0, self.truth
        if truth is None or self.scenario is None or self.scenario.course is not None:
            return times
        goal = build_goal(self.scenario, self.strategy)
        places = np.stack([truth.x, truth.y, truth.z], axis=1).tolist()
        for lamp in goal.stops[:-1]:
            there = (k for k in range(since, len(places)) if is_at_lamp(goal, lamp, *places[k]))
            first = next(there, None)
            # Later lamps cannot have been reached either
            if first is None:
                return times
            # Search the next lamp only after this sample
            since = first + 1
            times.append(float(truth.time[first]))
        came = math.inf
        for time, place in zip(truth.time[since:].tolist(), places[since:], strict=True):
            came = min(came, time) if is_at_lamp(goal, goal.stops[-1], *place) else math.inf
            if has_stayed(goal, came, time + SAMPLED):
                return [*times, came + goal.stay]
        return times

    @property
    def is_reached(self) -> bool:
        """Whether all target lamps were reached; False if there are none."""
        return len(self.arrivals) == len(self.places) > 0

    @property
    def shortest_path_length(self) -> float:
        """Length of the shortest path from the start through all goal circles [m]."""
        if self.truth is None or not self.places:
            return np.nan
        start = float(self.truth.x[0]), float(self.truth.y[0])
        return shortest_path_length(start, self.places, self.radius)

    def leg_index(self, time: Array) -> NDArray[np.intp]:
        """Return the index of the next lamp at each time [s]."""
        return np.minimum(np.searchsorted(self.arrivals, time), len(self.places) - 1)

    def lamp_distance(self, motion: MotionCurve) -> Array:
        """Return the horizontal distance to the next lamp; NaN if there is none [m]."""
        return np.hypot(*self._vector_to_place(motion, self.leg_index(motion.time), self.places))

    def lamp_direction(self, motion: MotionCurve) -> Array:
        """Return the direction to the next lamp in the body frame; NaN if there is none [rad]."""
        return self._body_direction(motion, self.leg_index(motion.time), self.places)

    def beacon_direction(self, motion: MotionCurve, frequency: Array) -> Array:
        """
        Return the direction to the lamp that the drone tracks, by its frequency.

        `motion`: the true motion. `frequency`, shape (instants,): tracked frequency, which selects
        the lamp with the nearest one; of several with that frequency, the one that the route leads
        to next [Hz]. The result has shape (instants,): body frame; NaN if there is no lamp [rad].
        """
        if self.scenario is None or not self.places:
            return np.full(len(motion.time), np.nan)
        lamps = list(self.scenario.lamps.values())
        own = np.array([lamp.frequency.si for lamp in lamps])
        distance = np.abs(frequency[:, None] - own)
        nearest = distance.argmin(axis=1)
        names = list(self.scenario.lamps)
        route = np.array([names.index(name) for name in self.scenario.route or names[:1]])
        following = route[self.leg_index(motion.time)]
        # Lamps of one frequency look alike to the drone
        alike = distance[np.arange(len(frequency)), following] <= distance.min(axis=1)
        meant = np.where(alike, following, nearest)
        return self._body_direction(
            motion, meant, [FloorPoint(*lamp.position.vector[:2]) for lamp in lamps]
        )

    @classmethod
    def _body_direction(
        cls, motion: MotionCurve, which: NDArray[np.intp], places: list[FloorPoint]
    ) -> Array:
        x, y = cls._vector_to_place(motion, which, places)
        return wrap_angle(np.arctan2(y, x) - motion.yaw)

    @staticmethod
    def _vector_to_place(
        motion: MotionCurve, which: NDArray[np.intp], places: list[FloorPoint]
    ) -> tuple[Array, Array]:
        """Return the vector to the selected place at each time, along x and y [m, map]."""
        if not places:
            unknown = np.full(len(motion.time), np.nan)
            return unknown, unknown
        there = np.array(places)[which]
        return there[:, 0] - motion.x, there[:, 1] - motion.y
