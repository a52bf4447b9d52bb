"""Apply the energy reserve to a mission in flight: land, return to the start, or continue."""

import math

from lta_config.errors import BadInput
from lta_control.phases import Mission, Phase
from lta_control.reserve import (
    FlightPermission,
    ReserveAction,
    ReserveResponseSettings,
    ReserveRule,
)
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy

Place = tuple[float, float]


def check_reserve(settings: ReserveResponseSettings, strategy: NavigationStrategy) -> None:
    """Raise `BadInput` if the strategy does not support the action at the reserve."""
    if settings.action == 'perch' and not strategy.arrives:
        raise BadInput(
            f'The strategy {strategy.name} never reports an arrival at a lamp, so it does not '
            'support reserve.action perch; choose the strategy homing, or set '
            'reserve.action to land or return.'
        )


def apply_reserve(
    rule: ReserveRule,
    speed: float,
    mission: Mission,
    sight: LightMeasurement,
    order: FlightPermission,
) -> Mission:
    """
    Return the mission after applying the energy reserve.

    A flight back is never restarted and always ends in a landing, wherever it has led: it uses
    dead reckoning, which drifts with the wind. `speed` is its airspeed. [m/s]
    """
    if mission.phase == Phase.HOME:
        mission = mission._replace(left=mission.left - sight.interval)
        near = distance_to_start(mission.start, sight.position) <= rule.home
        over = near or mission.left <= 0.0 or order == FlightPermission.DOWN
        return mission._replace(phase=Phase.LAND) if over else mission
    if order == FlightPermission.FLY or mission.phase == Phase.LAND:
        return mission
    # During the climb the drone is still near its start, so it lands at once.
    if order == FlightPermission.RESERVE and mission.phase != Phase.CLIMB:
        # Continue to the lamp; the landing follows on arrival
        if rule.action == ReserveAction.PERCH and mission.phase == Phase.SEEK:
            return mission
        if rule.action == ReserveAction.RETURN and speed > 0.0:
            way = distance_to_start(mission.start, sight.position)
            # A time limit, because a head wind may make the start unreachable
            left = rule.turning + rule.patience * way / speed
            return mission._replace(phase=Phase.HOME, left=left)
    return mission._replace(phase=Phase.LAND)


def heading_to_start(start: Place, place: Place) -> float:
    """Return the heading to the start. [rad, odom]"""
    return math.atan2(start[1] - place[1], start[0] - place[0])


def distance_to_start(start: Place, place: Place) -> float:
    """Return the distance from the start. [m]"""
    return math.hypot(start[0] - place[0], start[1] - place[1])
