# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Decide the outcome of a flight: goal reached, out of the room, out of time, or still flying.

`evaluate_outcome` is the rule, plain numbers and tuples so that it compiles; the world, batches
and the tests call it. A flight starts indoors and may leave the room through its door only.
"""

import math
from typing import final, NamedTuple

from lta_model.scenario import Scenario
from lta_sim.readings import FlightOutcome

OUTCOMES = tuple(FlightOutcome)
FLYING, REACHED, TIMEOUT, ESCAPED = range(4)  # places in OUTCOMES
Place = tuple[float, float, float]
TIME_ROUNDING = 1e-6  # s, of times that are compared
LIFT_OFF = 0.01  # m above the start that count as lift-off, with which the flight begins


class DoorBounds(NamedTuple):
    """The door in the wall at the high end of x, and how far a flight may go beyond it [m]."""

    middle: float
    half_width: float
    height: float
    reach: float  # 0 in a room without a door


class EndConditions(NamedTuple):
    """End conditions of a flight."""

    stops: tuple[Place, ...]  # lamps in the order in which they are to be reached [m, map]
    # Largest horizontal distance and difference of height at which a lamp is reached [m]
    radius: float
    vertical_tolerance: float
    stay: float  # time to stay at the last lamp [s]
    limit: float  # time limit [s]
    # Size of the room [m]
    half_length: float
    half_width: float
    height: float
    door: DoorBounds
    along: bool  # whether the flight follows a course instead of searching lamps


class GoalProgress(NamedTuple):
    """Index of the lamp to reach next, whether the drone is indoors, and its stay."""

    stop: int = 0
    indoors: bool = True
    since: float = math.inf  # time since which it has been at the last lamp; infinite away [s]


def build_goal(scenario: Scenario, strategy: str = '') -> EndConditions:
    """Return the end conditions of a scene for a navigation strategy; '' for none."""
    length, width, height = scenario.room.size.vector
    outside = scenario.outside
    door = DoorBounds(0.0, 0.0, 0.0, 0.0)
    if outside is not None:
        opening = outside.door
        door = DoorBounds(
            opening.middle.si, opening.width.si / 2, opening.height.si, outside.reach.si
        )
    return EndConditions(
        tuple((x, y, z) for x, y, z in (lamp.position.vector for lamp in scenario.target_lamps)),
        scenario.goal.radius.si,
        scenario.goal.vertical_tolerance.si,
        scenario.goal.find_stay(strategy),
        scenario.goal.time_limit.si,
        length / 2,
        width / 2,
        height,
        door,
        scenario.course is not None,
    )


def is_indoors(goal: EndConditions, x: float, y: float, z: float) -> bool:
    """Return whether a hull centre is in the room [m, map]."""
    return abs(x) <= goal.half_length and abs(y) <= goal.half_width and z <= goal.height


def is_in_bounds(goal: EndConditions, was_indoors: bool, x: float, y: float, z: float) -> bool:
    """Return whether a hull centre is where it may be, one control period after `was_indoors`."""
    door, indoors = goal.door, is_indoors(goal, x, y, z)
    if door.reach <= 0.0:
        return indoors
    # A change between indoors and outdoors is allowed only through the door.
    if indoors != was_indoors:
        return abs(y - door.middle) <= door.half_width and z <= door.height and x > 0.0
    return indoors or (
        x <= goal.half_length + door.reach and abs(y) <= door.reach and z <= door.reach
    )


def distance_to_goal(goal: EndConditions, progress: GoalProgress, x: float, y: float) -> float:
    """Return the horizontal distance to the lamp that is to be reached next [m]."""
    stop = goal.stops[progress.stop]
    return math.hypot(stop[0] - x, stop[1] - y)


def is_at_lamp(goal: EndConditions, lamp: Place, x: float, y: float, z: float) -> bool:
    """Return whether a hull centre is where a lamp counts as reached [m, map]."""
    near = math.hypot(lamp[0] - x, lamp[1] - y) <= goal.radius
    return near and abs(lamp[2] - z) <= goal.vertical_tolerance


def has_stayed(goal: EndConditions, since: float, time: float) -> bool:
    """Return whether a drone that came to the last lamp at `since` is reckoned to stay [s]."""
    return time - since >= goal.stay - TIME_ROUNDING


def evaluate_outcome(
    goal: EndConditions, progress: GoalProgress, x: float, y: float, z: float, elapsed: float
) -> tuple[int, GoalProgress]:
    """Return the outcome, as a place in `OUTCOMES`, and the progress after a control period."""
    inside = is_in_bounds(goal, progress.indoors, x, y, z)
    near = is_at_lamp(goal, goal.stops[progress.stop], x, y, z)
    indoors = is_indoors(goal, x, y, z)
    if indoors != progress.indoors:
        progress = progress._replace(indoors=indoors)
    last = progress.stop + 1 == len(goal.stops)
    since = min(progress.since, elapsed) if near and last else math.inf
    progress = progress._replace(since=since)
    if near and not goal.along:
        if not last:
            progress = progress._replace(stop=progress.stop + 1)
        elif has_stayed(goal, since, elapsed):
            return REACHED, progress
    if not inside:
        return ESCAPED, progress
    if elapsed >= goal.limit:
        # On a course, flying it to its end is the goal.
        return REACHED if goal.along else TIMEOUT, progress
    return FLYING, progress


@final
class FlightTermination:
    """The end conditions of one flight, from its start."""

    def __init__(self, scenario: Scenario, strategy: str = '', endless: bool = False) -> None:
        self._goal = build_goal(scenario, strategy)
        if endless:  # neither a lamp nor the time ends the flight
            self._goal = self._goal._replace(along=True, limit=math.inf)
        self._progress = GoalProgress()

    def goal_distance(self, x: float, y: float) -> float:
        """Return the horizontal distance to the lamp that is to be reached next [m]."""
        return distance_to_goal(self._goal, self._progress, x, y)

    def is_at_lamp(self, x: float, y: float, z: float) -> bool:
        """Return whether a hull centre is at the lamp that is to be reached next [m, map]."""
        return is_at_lamp(self._goal, self._goal.stops[self._progress.stop], x, y, z)

    def evaluate_outcome(self, x: float, y: float, z: float, elapsed: float) -> FlightOutcome:
        """Return the outcome of the flight after one more control period."""
        outcome, self._progress = evaluate_outcome(self._goal, self._progress, x, y, z, elapsed)
        return OUTCOMES[outcome]
