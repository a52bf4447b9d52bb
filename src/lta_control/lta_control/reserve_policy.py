"""What the energy makes of a mission in the air: land, fly back to the start, or go on."""

import math

from lta_config.errors import BadInput
from lta_control.phases import Mission, Phase
from lta_control.reserve import FlightPermission, ReserveActionSettings
from lta_control.strategies.protocol import LightSight, NavigationStrategy

Place = tuple[float, float]


def check_reserve(settings: ReserveActionSettings, strategy: NavigationStrategy) -> None:
    """Raise `BadInput` where a strategy cannot do what is asked of it at the reserve."""
    if settings.action == 'perch' and not strategy.arrives:
        raise BadInput(
            f'The strategy {strategy.name} never says that it has arrived, so that it cannot '
            'perch at the reserve; choose homing, or land or return.'
        )


def apply_reserve(
    settings: ReserveActionSettings,
    speed: float,
    mission: Mission,
    sight: LightSight,
    order: FlightPermission,
) -> Mission:
    """
    Return a mission in the air with what the energy makes of it.

    A flight back is never taken up anew, and ends in a landing wherever it has led: it is flown by
    dead reckoning, which the wind carries away.

    Parameters
    ----------
    settings : ReserveSettings
        What to do at the reserve.
    speed : float
        Airspeed of the flight back. [m/s]
    mission : Mission
        As it stands.
    sight : Sight
        Where the drone takes itself to be.
    order : Order
        What the energy allows.

    """
    if mission.phase is Phase.HOME:
        mission = mission._replace(left=mission.left - sight.interval)
        near = distance_to_start(mission.start, sight.position) <= settings.home
        over = near or mission.left <= 0.0 or order is FlightPermission.DOWN
        return mission._replace(phase=Phase.LAND) if over else mission
    if order is FlightPermission.FLY or mission.phase is Phase.LAND:
        return mission
    if order is FlightPermission.RESERVE and mission.phase is not Phase.CLIMB:
        if settings.action == 'perch' and mission.phase is Phase.SEEK:
            return mission
        if settings.action == 'return' and speed > 0.0:
            way = distance_to_start(mission.start, sight.position)
            left = settings.turning + settings.patience * way / speed
            return mission._replace(phase=Phase.HOME, left=left)
    return mission._replace(phase=Phase.LAND)


def heading_to_start(start: Place, place: Place) -> float:
    """Return the heading to the start. [rad, odom]"""
    return math.atan2(start[1] - place[1], start[0] - place[0])


def distance_to_start(start: Place, place: Place) -> float:
    """Return the distance from the start. [m]"""
    return math.hypot(start[0] - place[0], start[1] - place[1])
