# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly to a place and hold it: position -> velocity over ground -> heading and airspeed.

The rotors of a blimp push along its nose, and every turn pushes, too. The wanted velocity falls
with the distance such that the drone can turn about and stop (`homing.stopping_speed`). The nose
turns to the force that this takes: drag at the wanted airspeed, and what changes the velocity.
Against a wind the drone so stands with its nose into it. In calm air it rests near the place,
without turning, until it has drifted too far.
"""

import math
from typing import NamedTuple

from lta_control.motion import wrap_angle
from lta_control.odometry.tracked_motion import LocatedMotion, Pair
from lta_control.strategies.homing import LARGEST_TURN, limit_turn, stopping_speed
from lta_control.strategies.settings import StrategySettings

CHANGE_TIME = 3.0  # s in which the velocity is to change
APPROACH_SPEED = (
    0.3  # m/s over ground towards a place, or the setting `speed` where that is slower
)
REST_WIND = 0.1  # m/s; in less wind a drone rests
CALM_TURN = 0.5  # rad ahead of the nose in calm air: slow turns push little
REST_SPEED = 0.05  # m/s over ground, below which it begins to rest, and ...
LEAVE_SPEED = 0.12  # m/s, above which it no longer does
REST_DISTANCE = 0.5  # m from the place, within which it begins to rest; twice that, it returns


class Place(NamedTuple):
    """Where to fly, in the map [m]."""

    x: float
    y: float
    height: float  # of the hull centre above the floor; 0: as before


class Route(NamedTuple):
    """Places to fly to, one after the other."""

    places: tuple[Place, ...] = ()
    tolerance: float = 0.0  # distance that counts as there; 0: as in the settings [m]


class PlaceHold(NamedTuple):
    """A place that is held, and the state of the hold."""

    goal: Pair  # [m, in the frame of `LocatedMotion`]
    tracked: bool  # whether that is the map
    heading: float  # last commanded [rad, in that frame]
    resting: bool = False


def begin_hold(motion: LocatedMotion, goal: Pair) -> PlaceHold:
    """Return the hold of a place, before its first step."""
    return PlaceHold(goal, motion.tracked, motion.heading)


def steer_to_place(
    settings: StrategySettings, hold: PlaceHold, motion: LocatedMotion
) -> tuple[float, PlaceHold]:
    """Return the forward airspeed [m/s], and the hold with the new heading."""
    own, wind = settings.homing, math.hypot(*motion.wind)
    x, y = hold.goal[0] - motion.position[0], hold.goal[1] - motion.position[1]
    away, speed = math.hypot(x, y), math.hypot(*motion.velocity)
    near, slow = (2.0, LEAVE_SPEED) if hold.resting else (1.0, REST_SPEED)
    if wind < REST_WIND and away < near * REST_DISTANCE and speed < slow:
        heading = hold.heading if hold.resting else motion.heading
        return 0.0, hold._replace(heading=heading, resting=True)
    lead = min(settings.speed, APPROACH_SPEED, stopping_speed(own, away, math.pi)) / max(
        away, 1e-9
    )
    # Velocity through the air, and the force per mass for it
    ahead, left = lead * x - motion.wind[0], lead * y - motion.wind[1]
    drag = math.hypot(ahead, left) / own.coasting
    push_x = drag * ahead + (lead * x - motion.velocity[0]) / CHANGE_TIME
    push_y = drag * left + (lead * y - motion.velocity[1]) / CHANGE_TIME
    heading = math.atan2(push_y, push_x)
    airspeed = ahead * math.cos(heading) + left * math.sin(heading)
    most = CALM_TURN if wind < REST_WIND else LARGEST_TURN
    heading = limit_turn(heading, motion.heading, hold.heading, most)
    airspeed = min(max(airspeed, -own.top_speed), own.top_speed)
    return airspeed, hold._replace(heading=wrap_angle(heading), resting=False)


def find_route_fault(
    route: Route, room: tuple[float, float, float] | None, lowest: float, highest: float
) -> str:
    """
    Return why places cannot be flown to, or ''.

    Parameters
    ----------
    room : 3-tuple of float or None
        Length, width and height of the room around the origin of the map. [m]
    lowest, highest : float
        Limits of the height. [m]

    """
    if not route.places:
        return 'there is no place to fly to'
    if not 0.0 <= route.tolerance < math.inf:
        return f'a tolerance of {route.tolerance:g} m cannot be flown; give 0 or more'
    for x, y, height in route.places:
        if not all(map(math.isfinite, (x, y, height))):
            return f'the place {x:g}, {y:g}, {height:g} m is not finite'
        if room is not None and (2.0 * abs(x) > room[0] or 2.0 * abs(y) > room[1]):
            return (
                f'the place {x:g}, {y:g} m lies outside the room, {room[0]:g} m x {room[1]:g} m '
                'around the origin'
            )
        top = highest if room is None else min(highest, room[2])
        if height != 0.0 and not lowest < height <= top:
            return (
                f'the hull centre cannot fly {height:g} m above the ground; give more than '
                f'{lowest:.2f}, at most {top:g}, or 0 for its present height'
            )
    return ''
