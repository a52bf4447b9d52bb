"""The goal of a flight: the lamps to be reached, in their order, and when each was."""

from dataclasses import dataclass
from functools import cached_property
from typing import final

from lta_model.scenario import Scenario
from lta_report.curves import Array, FloorPoint, MotionCurve
import numpy as np
from numpy.typing import NDArray


@final
@dataclass(frozen=True)
class FlightGoal:
    """
    The goal of one flight.

    Parameters
    ----------
    scenario : Scenario or None
        Where the lamps are; None where it is not known.
    truth : Motion or None
        The true motion; None where it is not known.

    """

    scenario: Scenario | None
    truth: MotionCurve | None

    @cached_property
    def places(self) -> list[FloorPoint]:
        """The lamps to be reached in their order: none on a course, or where none is known."""
        if self.scenario is None or self.scenario.course is not None:
            return []
        return [FloorPoint(*lamp.position.vector[:2]) for lamp in self.scenario.target_lamps]

    @property
    def radius(self) -> float:
        """How near counts as reached; NaN where it is not known. [m]"""
        return np.nan if self.scenario is None else self.scenario.goal.radius.si

    @cached_property
    def arrivals(self) -> list[float]:
        """
        When each lamp was truly reached, one after the other, as far as they were. [s]

        A lamp counts in its turn only: a round that ends where it began is not over at the start.
        """
        found, since = list[float](), 0
        if self.truth is None:
            return found
        time, x, y = self.truth.time, self.truth.x, self.truth.y
        for lamp in self.places:
            there = np.hypot(lamp.x - x[since:], lamp.y - y[since:]) <= self.radius
            if not there.any():
                break
            since += int(there.argmax()) + 1
            found.append(float(time[since - 1]))
        return found

    @property
    def is_reached(self) -> bool:
        """Whether all lamps were; False where there are none."""
        return len(self.arrivals) == len(self.places) > 0

    @property
    def shortest_length(self) -> float:
        """The shortest way from the start through all goal circles; NaN where unknown. [m]"""
        if self.truth is None or not self.places:
            return np.nan
        way = np.array([(self.truth.x[0], self.truth.y[0]), *self.places])
        legs = np.hypot(*np.diff(way, axis=0).T) - 2.0 * self.radius
        legs[0] += self.radius  # the start is a point
        return float(np.maximum(legs, 0.0).sum())

    def leg_index(self, time: Array) -> NDArray[np.intp]:
        """Return which of the lamps is next at each instant [s], from 0."""
        return np.minimum(np.searchsorted(self.arrivals, time), len(self.places) - 1)

    def lamp_distance(self, motion: MotionCurve) -> Array:
        """Return the horizontal distance to the lamp that is next, NaN where none is. [m]"""
        return np.hypot(*self._place_offset(motion, self.leg_index(motion.time), self.places))

    def lamp_direction(self, motion: MotionCurve) -> Array:
        """Return the direction to the lamp that is next, body frame; NaN where none is. [rad]"""
        return self._body_direction(motion, self.leg_index(motion.time), self.places)

    def beacon_direction(self, motion: MotionCurve, frequency: Array) -> Array:
        """
        Return the direction to the lamp that the drone listens for, which follows its own belief.

        Parameters
        ----------
        motion : Motion
            The true one.
        frequency : ndarray, shape (instants,)
            What is listened for: the lamp of the nearest frequency is meant. [Hz]

        Returns
        -------
        ndarray, shape (instants,)
            Body frame; NaN where there is no lamp. [rad]

        """
        if self.scenario is None or not self.places:
            return np.full(len(motion.time), np.nan)
        lamps = list(self.scenario.lamps.values())
        own = np.array([lamp.frequency.si for lamp in lamps])
        meant = np.abs(frequency[:, None] - own).argmin(axis=1)
        return self._body_direction(
            motion, meant, [FloorPoint(*lamp.position.vector[:2]) for lamp in lamps]
        )

    @classmethod
    def _body_direction(
        cls, motion: MotionCurve, which: NDArray[np.intp], places: list[FloorPoint]
    ) -> Array:
        x, y = cls._place_offset(motion, which, places)
        return wrap_angle(np.arctan2(y, x) - motion.yaw)

    @staticmethod
    def _place_offset(
        motion: MotionCurve, which: NDArray[np.intp], places: list[FloorPoint]
    ) -> tuple[Array, Array]:
        """Return the way to one of some places at each instant, along x and y. [m, map]"""
        if not places:
            unknown = np.full(len(motion.time), np.nan)
            return unknown, unknown
        there = np.array(places)[which]
        return there[:, 0] - motion.x, there[:, 1] - motion.y


def wrap_angle(angle: Array) -> Array:
    """Return angles in [-pi, pi). [rad]"""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi
