"""
What the drone is about: rest, climb, seek the lamp, stay there, and land when the energy says so.

A mission is a phase and its strategy's memory. Phases only go forward, except that on a route of
several lamps the drone seeks the next one when it has arrived at one. It listens for the next lamp
while it still holds its place, and goes only when that lamp is heard for a while; otherwise it
listens to the lamp where it is again, stays, and asks once more later.

With the energy reserve reached it lands, returns to its start or goes on to the lamp, as `reserve`
says; on the ground it stays there. What it may not do it does not begin again: it lands for good.

What is heard belongs to the beacon that was asked for a turn ago (`topics.yaml`, light/beacon).
"""

from typing import final

from lta_config.course import Course
from lta_config.settings import setting
from lta_control.cascade import Setpoint
from lta_control.phases import Mission, Phase, SWITCHING
from lta_control.reserve import FlightPermission, ReserveActionSettings
from lta_control.reserve_policy import apply_reserve, heading_to_start
from lta_control.strategies.protocol import LightSight, NavigationStrategy
from lta_control.strategies.settings import StrategySettings


@final
class MissionSettings(StrategySettings):
    """The mission's figures; altitudes are of the hull centre above the floor."""

    altitude: float = setting(0.5, 'Altitude to fly at.', unit='m', low=0.1, high=100.0)
    reached: float = setting(
        0.04, 'The climb ends this near the altitude.', unit='m', low=0.001, high=1.0
    )
    landing: float = setting(
        0.3,
        'Altitude asked for when landing; below where the gear stands.',
        unit='m',
        low=0.0,
        high=100.0,
    )
    heard: float = setting(
        0.5, 'Time for which the next lamp of a route must be heard.', unit='s', low=0.1, high=60.0
    )
    patience: float = setting(
        3.0, 'Time to listen for the next lamp of a route.', unit='s', low=0.5, high=600.0
    )
    again: float = setting(
        10.0, 'Time until it is listened for again.', unit='s', low=0.5, high=3600.0
    )


def mission_step(
    settings: MissionSettings,
    strategy: NavigationStrategy,
    mission: Mission,
    sight: LightSight,
    altitude: float | None,
    order: FlightPermission,
    lamps: int = 1,
    reserve: ReserveActionSettings = ReserveActionSettings(),  # noqa: B008 - frozen
) -> tuple[Setpoint, Mission]:
    """
    Return what the controller should hold, and the mission as it now stands.

    Parameters
    ----------
    settings : MissionSettings
        Altitudes and speeds.
    strategy : Strategy
        Steers while seeking.
    mission : Mission
        As it stood.
    sight : Sight
        The newest light.
    altitude : float or None
        Estimated; None while it is too early to take off: the estimator is learning its biases,
        or nothing is known of the energy. [m]
    order : Order
        What the energy allows.
    lamps : int
        On the route.
    reserve : ReserveSettings
        What to do when the energy reserve is reached.

    """
    phase, memory = mission.phase, mission.memory
    if altitude is None or (phase is Phase.REST and order is not FlightPermission.FLY):
        return Setpoint(0.0, sight.heading, 0.0), mission
    if phase is Phase.REST:
        phase, memory = Phase.CLIMB, strategy.start(sight.heading)
        mission = mission._replace(start=sight.position)
    if phase is Phase.CLIMB and altitude > settings.altitude - settings.reached:
        phase = Phase.SEEK
    mission = mission._replace(phase=phase, memory=memory)
    mission = apply_reserve(reserve, settings.speed, mission, sight, order)
    phase, memory = mission.phase, mission.memory
    if phase is Phase.HOME:
        heading = heading_to_start(mission.start, sight.position)
        mission = mission._replace(memory=(heading, *memory[1:]))
        return Setpoint(settings.altitude, heading, settings.speed), mission
    if phase is Phase.SEEK or phase is Phase.ARRIVED:
        return _steer_by_strategy(settings, strategy, mission, sight, lamps)
    if phase is Phase.CLIMB and strategy.watch is not None:
        memory = strategy.watch(settings, memory, sight)
        mission = mission._replace(memory=memory)
    height = settings.landing if phase is Phase.LAND else settings.altitude
    return Setpoint(height, memory[0], 0.0), mission


def _steer_by_strategy(
    settings: MissionSettings,
    strategy: NavigationStrategy,
    mission: Mission,
    sight: LightSight,
    lamps: int,
) -> tuple[Setpoint, Mission]:
    """Return what the strategy asks for, and hand over to the next lamp where it has arrived."""
    known = mission.asked == mission.leg and mission.turns >= SWITCHING
    course, memory = strategy.steer(
        settings, mission.memory, sight if known else remove_light(sight)
    )
    setpoint = Setpoint(settings.altitude, course.heading, course.speed)
    mission = mission._replace(memory=memory)
    if course.arrived:
        mission = mission._replace(phase=Phase.ARRIVED)
    if lamps > 1:
        mission = _listen_for_next(settings, strategy, mission, sight, lamps)
    return setpoint, mission


def remove_light(sight: LightSight) -> LightSight:
    """Return a sight without its light: of another lamp, or of none."""
    return sight._replace(seen=False, bearing=0.0, deviation=0.0, strength=0.0, elevation=0.0)


def _listen_for_next(
    settings: MissionSettings,
    strategy: NavigationStrategy,
    mission: Mission,
    sight: LightSight,
    lamps: int,
) -> Mission:
    """Return a mission of several lamps after one more turn of listening."""
    turns = mission.turns + 1
    heard = mission.heard + 1 if sight.seen and turns > SWITCHING else 0
    mission = mission._replace(turns=turns, heard=heard)
    if mission.phase is not Phase.ARRIVED or mission.leg + 1 == lamps:
        return mission
    time = turns * sight.interval
    if mission.asked == mission.leg:
        wait = settings.again if mission.refused else 0.0
        if time < wait:
            return mission
        return mission._replace(asked=mission.leg + 1, turns=0, heard=0)
    if heard * sight.interval >= settings.heard and strategy.onward is not None:
        memory = strategy.onward(mission.memory)
        leg = mission.asked
        return mission._replace(
            phase=Phase.SEEK, memory=memory, leg=leg, turns=turns, heard=heard, refused=False
        )
    if time >= settings.patience:
        return mission._replace(asked=mission.leg, turns=0, heard=0, refused=True)
    return mission


def course_step(
    course: Course, time: float, heading: float, altitude: float | None, order: FlightPermission
) -> Setpoint:
    """
    Return what the controller should hold on a course that is flown instead of a search.

    Parameters
    ----------
    course : Course
        The course.
    time : float
        Since the first light. [s]
    heading : float
        Of the drone, which it keeps on the floor. [rad]
    altitude, order
        As of `mission_step`; what the energy does not allow ends where the drone is.

    """
    if altitude is None:
        return Setpoint(0.0, heading, 0.0)
    asked = course.setpoint_at(time)
    if order is not FlightPermission.FLY:
        return Setpoint(0.0, asked.heading, 0.0)
    return Setpoint(asked.altitude, asked.heading, asked.speed)
