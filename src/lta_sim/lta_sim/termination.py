"""Decide the outcome of a flight: goal reached, out of the room, out of time, or still flying."""

import math
from typing import final

from lta_model.scenario import Scenario
from lta_sim.bounds import FlightBounds
from lta_sim.readings import FlightOutcome


@final
class FlightTermination:
    """End conditions of a flight; the lamps of a route must be reached in order."""

    def __init__(self, scenario: Scenario) -> None:
        self._bounds = FlightBounds(scenario)
        self._stops = [lamp.position.vector[:2] for lamp in scenario.target_lamps]
        self._radius, self._limit = scenario.goal.radius.si, scenario.goal.time_limit.si
        # A course is a prescribed trajectory; it has no lamps to reach
        self._along = scenario.course is not None

    def goal_distance(self, x: float, y: float) -> float:
        """Return the horizontal distance to the next lamp. [m]"""
        return math.dist(self._stops[0], (x, y))

    def evaluate_outcome(self, x: float, y: float, z: float, elapsed: float) -> FlightOutcome:
        """Return the current outcome of the flight."""
        # Evaluated first, because the bounds track every step
        in_bounds = self._bounds.is_inside(x, y, z)
        if not self._along and self.goal_distance(x, y) <= self._radius:
            if len(self._stops) == 1:
                return FlightOutcome.REACHED
            del self._stops[0]
        if not in_bounds:
            return FlightOutcome.ESCAPED
        if elapsed >= self._limit:
            # On a course, flying it to its end is the goal.
            return FlightOutcome.REACHED if self._along else FlightOutcome.TIMEOUT
        return FlightOutcome.FLYING
